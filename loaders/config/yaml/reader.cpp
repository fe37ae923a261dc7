// SPDX-License-Identifier: MIT
//
// Reads a configuration in YAML. The library parses; everything that the user is told is decided here, since it accepts
// repeated keys and names no places in its own conversions.
#include "loaders/config/yaml/reader.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace lapidary {

namespace {

namespace fs = std::filesystem;

constexpr int most_threads = 4096;

class Reader {
public:
    Reader(const SourceFile& source, Configuration& configuration, Messages& messages)
        : source_(source), configuration_(configuration), messages_(messages) {}

    void read() {
        try {
            const std::vector<YAML::Node> documents = YAML::LoadAll(source_.text);
            if (documents.size() > 1)
                messages_.error(place(documents[1].Mark()),
                                "a configuration is one YAML document; remove what follows the '---'");
            if (!documents.empty()) read_settings(documents[0]);
        } catch (const YAML::Exception& failure) {
            messages_.error(place(failure.mark), fmt::format("this is not valid YAML: {}", failure.msg));
        }
    }

private:
    using Setting = void (Reader::*)(const YAML::Node& value, const Place& key);

    const SourceFile& source_;
    Configuration& configuration_;
    Messages& messages_;

    static const std::map<std::string, Setting, std::less<>>& settings() {
        static const std::map<std::string, Setting, std::less<>> table = {
            {"include_path", &Reader::read_include_path},
            {"plugin_path", &Reader::read_plugin_path},
            {"threads", &Reader::read_threads},
        };
        return table;
    }

    void read_settings(const YAML::Node& root) {
        if (root.IsNull()) return;
        if (!root.IsMap()) {
            messages_.error(place(root.Mark()), "a configuration is made of lines 'setting: value'; the settings are " + names());
            return;
        }
        std::map<std::string, Place, std::less<>> seen;
        for (const auto& entry : root) {
            const Place key_place = place(entry.first.Mark());
            if (!entry.first.IsScalar()) {
                messages_.error(key_place, "the name of a setting is a word; the settings are " + names());
                continue;
            }
            const std::string& key = entry.first.Scalar();
            const auto setting = settings().find(key);
            if (setting == settings().end()) {
                messages_.error(key_place, fmt::format("unknown setting '{}'{}; the settings are {}", key,
                                                       did_you_mean(key, name_list()), names()));
                continue;
            }
            if (const auto [first, is_new] = seen.emplace(key, key_place); !is_new) {
                messages_.error(key_place, fmt::format("the setting '{}' was already given in line {}; keep one of the two", key,
                                                       first->second.line));
                continue;
            }
            (this->*setting->second)(entry.second, key_place);
        }
    }

    void read_plugin_path(const YAML::Node& value, const Place& key) { read_folders(value, key, configuration_.plugin_path); }
    void read_include_path(const YAML::Node& value, const Place& key) { read_folders(value, key, configuration_.include_path); }

    void read_threads(const YAML::Node& value, const Place& key) {
        int threads = 0;
        if (value.IsScalar()) {
            const std::string& text = value.Scalar();
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), threads);
            if (error == std::errc() && end == text.data() + text.size() && threads >= 0 && threads <= most_threads) {
                configuration_.threads = threads;
                return;
            }
        }
        messages_.error(
            place_of(value, key),
            fmt::format("'threads' takes a whole number from 0 to {}; 0 means as many as the machine has", most_threads));
    }

    void read_folders(const YAML::Node& value, const Place& key, std::vector<fs::path>& folders) {
        if (!value.IsSequence()) return read_folder(value, key, folders);
        for (const YAML::Node& element : value) read_folder(element, key, folders);
    }

    void read_folder(const YAML::Node& value, const Place& key, std::vector<fs::path>& folders) {
        if (!value.IsScalar() || value.Scalar().empty() || value.Scalar().find('\0') != std::string::npos) {
            messages_.error(place_of(value, key), "a folder is expected, or a list of folders: [one, two]");
            return;
        }
        folders.push_back(absolute(value.Scalar()));
        std::error_code error;
        if (!fs::is_directory(folders.back(), error))
            messages_.warning(place(value.Mark()),
                              fmt::format("there is no folder '{}'; it is passed over", folders.back().string()));
    }

    // Relative folders count from the file's own; '~/' is the home.
    fs::path absolute(const std::string& folder) const {
        const char* const home = std::getenv("HOME");
        if (home && (folder == "~" || folder.starts_with("~/")))
            return (fs::path(home) / folder.substr(1 + (folder.size() > 1))).lexically_normal();
        return (fs::absolute(source_.name).parent_path() / folder).lexically_normal();
    }

    Place place(const YAML::Mark& mark) const {
        if (mark.is_null()) return {&source_, 0, 0};
        return {&source_, static_cast<std::uint32_t>(mark.line + 1), static_cast<std::uint32_t>(mark.column + 1)};
    }

    // The library marks a value that is missing on a line after it: the key is what the user sees.
    Place place_of(const YAML::Node& value, const Place& key) const { return value.IsNull() ? key : place(value.Mark()); }

    static std::vector<std::string> name_list() {
        std::vector<std::string> list;
        for (const auto& [name, setting] : settings()) list.push_back(name);
        return list;
    }

    static std::string names() {
        std::string text;
        for (const auto& [name, setting] : settings()) text += (text.empty() ? "" : ", ") + name;
        return text;
    }
};

}  // namespace

extern "C" LAPIDARY_API void lapidary_read_yaml_configuration(const SourceFile& source, Configuration& configuration,
                                                              Messages& messages) {
    Reader(source, configuration, messages).read();
}

}  // namespace lapidary
