// SPDX-License-Identifier: MIT
//
// Errors and warnings about the user's input: sentences with a place, a cause and a remedy, collected so that one
// run shows them all.
//
//     scenes/dice.scene:3:7: error: unknown keyword 'spere'; did you mean 'sphere'?
//         spere { radius(2); }
//         ^
//       included from scenes/all.scene:9:1
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/export.h"
#include "kernel/report/place.h"

namespace lapidary {

enum class Severity { warning, error };

struct Message {
    Severity severity = Severity::error;
    std::string text;  // the sentence, without place
    std::string file;  // empty: no file
    std::uint32_t line = 0, column = 0;
    std::string excerpt;                     // the source line, tabs and control characters made visible, shortened if very long
    std::uint32_t caret = 0;                 // column of the caret within the excerpt, from 0
    std::vector<std::string> included_from;  // "file:line:column", innermost first

    // The whole message as the terminal shows it, ending in a line end.
    LAPIDARY_API std::string format() const;
    // "file:line:column: error: text", one line.
    LAPIDARY_API std::string headline() const;
};

// Thread-safe. Keeps messages in the order in which they came; of each severity at most `limit` are kept and told, so
// that a broken file stays readable and warnings never hide an error. The rest are only counted. What was said of a
// place once, in the first round of a loop, is not said again.
class LAPIDARY_API Messages {
public:
    using Listener = std::function<void(const Message&)>;

    explicit Messages(std::size_t limit = 100) : limit_(limit) {}

    void error(const Place& place, std::string text);
    void warning(const Place& place, std::string text);
    void add(Message message);
    // Is told of every message that is kept, as it comes.
    void listen(Listener listener);
    // Tells the listener of the last line, "… and N more", where there is one. For the end of a run.
    void finish();

    std::size_t errors() const;
    std::size_t warnings() const;
    bool has_errors() const { return errors() > 0; }
    // Whether a further error would be kept; if not, it is not worth the search for a suggestion.
    bool wants_errors() const { return errors() < limit_; }
    // What was kept, and the last line where something was not.
    std::vector<Message> all() const;

private:
    std::size_t& count(Severity severity) { return severity == Severity::error ? errors_ : warnings_; }
    void add_at(Severity severity, const Place& place, std::string text);
    bool is_kept(Severity severity, const Place& place, const std::string& text) const;
    Message remainder() const;  // its text is empty where everything was kept

    mutable std::mutex mutex_;
    std::size_t limit_;
    std::vector<Message> messages_;
    std::size_t errors_ = 0, warnings_ = 0;
    Listener listener_;
};

// The candidates nearest to a misspelt word (optimal string alignment distance at most a third of its length, at
// least 1), nearest first, at most three.
LAPIDARY_API std::vector<std::string> nearest_names(std::string_view word, const std::vector<std::string>& candidates);

// "; did you mean 'a', 'b' or 'c'?", or nothing where no candidate is near.
LAPIDARY_API std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace lapidary
