// SPDX-License-Identifier: MIT
#include "apps/lapidary/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cstdio>

#include "kernel/registry/search_path.h"
#include "kernel/report/messages.h"

namespace lapidary {

namespace {

constexpr const char* epilogue = R"(
Commands (the first word; without one, a scene is rendered):
  render SCENE       renders a scene
  check SCENE        lists all messages about a scene (--json for programs)
  plugins            lists the plugins found, and those refused with the reason
  help [KEYWORD]     explains a keyword of the scene language
  compare A B        measures how far two pictures differ
  converge SCENE     measures whether pictures keep the error asked for
Each has its own --help.

Exit status: 0 success, 1 failure, 2 wrong usage, 3 errors in the scene, 4 a file
cannot be written, 5 pictures differ by more than they may, 130 interrupted (what was
done is written).
)";

// Reads exactly the integers that stand between the separators.
template <std::size_t count>
std::optional<std::array<int, count>> integers(const std::string& text, char separator) {
    std::array<int, count> numbers{};
    const char* at = text.data();
    const char* const end = at + text.size();
    for (std::size_t i = 0; i < count; ++i) {
        if (i > 0 && (at == end || *at++ != separator)) return std::nullopt;
        const auto [next, error] = std::from_chars(at, end, numbers[i]);
        if (error != std::errc{}) return std::nullopt;
        at = next;
    }
    return at == end ? std::optional(numbers) : std::nullopt;
}

PixelRegion parse_region(const std::string& text) {
    const auto numbers = integers<4>(text, ',');
    if (!numbers) throw UsageError(fmt::format("--region takes four whole numbers, x0,y0,x1,y1, not '{}'", text));
    const auto [x0, y0, x1, y1] = *numbers;
    const PixelRegion region{x0, y0, x1, y1};
    if (x0 < 0 || y0 < 0 || region.is_empty())
        throw UsageError(fmt::format("--region {} holds no pixel; x0 and y0 count from 0 and lie below x1 and y1", text));
    return region;
}

// The setting that means the same.
std::string resolution_setting(const std::string& text) {
    const auto numbers = integers<2>(text, 'x');
    if (!numbers || (*numbers)[0] < 1 || (*numbers)[1] < 1)
        throw UsageError(fmt::format("--resolution takes two whole numbers above 0, as in 640x480, not '{}'", text));
    return fmt::format("output.resolution={},{}", (*numbers)[0], (*numbers)[1]);
}

std::chrono::duration<double> parse_duration(const std::string& text) {
    double value = 0;
    const auto [unit, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string_view rest(unit, text.data() + text.size());
    const double scale = rest.empty() || rest == "s"    ? 1
                         : rest == "ms"                 ? 1e-3
                         : rest == "min" || rest == "m" ? 60
                         : rest == "h"                  ? 3600
                                                        : 0;
    if (error != std::errc{} || !(value > 0) || scale == 0 || !(value * scale <= 1e9))
        throw UsageError(fmt::format("--time takes a time above 0, as in 30s, 500ms, 2min or 1h, not '{}'", text));
    return std::chrono::duration<double>(value * scale);
}

// Refuses every other number and what is none: comparisons alone would let "nan" pass.
CLI::Validator number_that_is(const char* range, bool (*holds)(double)) {
    const auto refusal = [range, holds](const std::string& text) {
        double value = 0;
        const char* const end = text.data() + text.size();
        const auto [next, error] = std::from_chars(text.data(), end, value);
        const bool fits = error == std::errc{} && next == end && holds(value);
        return fits ? std::string() : fmt::format("takes numbers {}, not '{}'", range, text);
    };
    return {[refusal](std::string& text) { return refusal(text); }, ""};
}

CLI::Validator possible_error() {
    return number_that_is("above 0, at most 1", [](double value) { return value > 0 && value <= 1; });
}

CLI::Validator at_least_zero() {
    return number_that_is("from 0 up", [](double value) { return value >= 0; });
}

// Options may be given several times, each with folders separated by colons.
std::vector<std::filesystem::path> split_folders(const std::vector<std::string>& lists) {
    std::vector<std::filesystem::path> folders;
    for (const std::string& list : lists)
        for (const auto& folder : split_path_list(list)) folders.push_back(folder);
    return folders;
}

// One command's options and what reads them.
class Parser {
public:
    Parser(std::string name, std::string description) : app_(std::move(description), std::move(name)) {
        app_.set_help_flag("-?,-h,--help", "Show this help.");
        app_.set_version_flag("--version", fmt::format("lapidary {} for {}", LAPIDARY_VERSION, kernel_level()),
                              "Show the version.");
        app_.get_formatter()->column_width(32);
    }

    CLI::App& app() { return app_; }

    // False: help or the version was asked for, and is written.
    bool parse(const Words& words) {
        try {
            app_.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 takes the words from the back
            return true;
        } catch (const CLI::Success& request) {
            app_.exit(request);
            return false;
        } catch (const CLI::ExtrasError&) {
            throw UsageError(unknown_words());
        } catch (const CLI::ParseError& error) {
            throw UsageError(fmt::format("{}; {} --help lists the options", error.what(), app_.get_name()));
        }
    }

private:
    std::string unknown_words() const {
        const std::vector<std::string> extras = app_.remaining();
        const std::string word = extras.empty() ? "" : extras.front();
        if (word.empty() || word[0] != '-')
            return fmt::format("'{}' is one word too many; {} --help lists what is taken", word, app_.get_name());
        std::vector<std::string> options;
        for (const CLI::Option* option : app_.get_options())
            for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
        return fmt::format("there is no option '{}'{}; {} --help lists the options", word, did_you_mean(word, options),
                           app_.get_name());
    }

    CLI::App app_;
};

// Options whose text is understood after parsing.
struct SceneTexts {
    std::string file;
    std::vector<std::string> plugin_path, include_path;
};

void add_plugin_path(CLI::App& app, std::vector<std::string>& folders) {
    app.add_option("--plugin-path", folders, "Folders searched first for plugins, separated by colons.")
        ->type_name("FOLDERS")
        ->allow_extra_args(false);
}

void add_scene_options(CLI::App& app, SceneTexts& texts, SceneOptions& options) {
    app.add_option("scene", texts.file, "The scene file.")->required()->type_name("");
    add_plugin_path(app, texts.plugin_path);
    app.add_option("--include-path", texts.include_path, "Folders searched for included files, separated by colons.")
        ->type_name("FOLDERS")
        ->allow_extra_args(false);
    app.add_option("--set", options.settings, "Change a property of the scene: camera.location=0,1,-5.")
        ->type_name("BLOCK.PROPERTY=VALUE")
        ->allow_extra_args(false);
    app.add_option("--max-items", options.max_items, "How many items `repeat` and `include` may produce.")
        ->type_name("N")
        ->capture_default_str();
}

void take_scene_texts(const SceneTexts& texts, SceneOptions& options) {
    options.file = texts.file;
    options.plugin_path = split_folders(texts.plugin_path);
    options.include_path = split_folders(texts.include_path);
}

}  // namespace

std::optional<RenderArguments> parse_render(const Words& words) {
    Parser parser("lapidary", "Renders a scene of solids: lapidary [options] scene");
    CLI::App& app = parser.app();
    app.footer(epilogue);
    RenderArguments arguments;
    SceneTexts scene;
    std::string name, resolution, region, time;
    bool bmp = false, tga = false;

    add_scene_options(app, scene, arguments.scene);
    app.add_option("-o,--output", name, "The picture's file; its extension may choose the format.")->type_name("FILE");
    app.add_flag("-b,--bmp", bmp, "Write a Windows bitmap.");
    app.add_flag("-t,--tga", tga, "Write a Targa file.");
    app.add_option("--resolution", resolution, "Pixels of the picture: 640x480.")->type_name("WxH");
    app.add_option("--region", region, "Render only the pixels x0 <= x < x1, y0 <= y < y1.")->type_name("x0,y0,x1,y1");
    app.add_option("-j,--threads", arguments.threads, "Threads; 0: as many as the machine has.")
        ->type_name("N")
        ->check(CLI::Range(0, 4096));
    app.add_option("--samples", arguments.samples, "Rays a pixel, exactly.")->type_name("N")->check(CLI::Range(1, 1 << 20));
    app.add_option("--error", arguments.error, "The estimated error of a pixel that is good enough.")
        ->type_name("E")
        ->check(possible_error());
    app.add_option("--time", time, "The best picture in that time: 30s.")->type_name("TIME");
    app.add_flag("-d,--parse-only", arguments.parse_only, "Read the scene and show what was understood; render nothing.");
    app.add_flag("-l,--log", arguments.log, "Write a log beside the picture.");
    app.add_flag("-s,--no-warnings", arguments.no_warnings, "Show no warnings; they stay in the log.");
    app.add_flag("-v,--verbose", arguments.verbose, "Show stages, times and statistics.");
    app.add_flag("-f,--full-screen", arguments.full_screen, "Show the picture on the full screen.");
    app.add_flag("-w,--no-window", arguments.no_window, "Show no window.");
    app.add_flag("--preview", arguments.preview, "Draw the picture in the terminal.");
    app.add_flag("--hold", arguments.hold, "Keep the window open at the end, as is done on a terminal.");
    app.add_flag("--watch", arguments.watch, "Render again whenever the scene or an included file is saved.");
    // For measurements; help does not show it.
    app.add_flag("--one-by-one", arguments.one_by_one, "Trace single rays, no packets.")->group("");
    app.add_option("--sequence", arguments.sequence, "Samples that are independent of those of other sequences.")->group("");
    if (!parser.parse(words)) return std::nullopt;

    take_scene_texts(scene, arguments.scene);
    if (!name.empty()) arguments.name = name;
    if (bmp) arguments.formats.emplace_back("bmp");
    if (tga) arguments.formats.emplace_back("tga");
    if (!resolution.empty()) arguments.scene.settings.push_back(resolution_setting(resolution));
    if (!region.empty()) arguments.region = parse_region(region);
    if (!time.empty()) arguments.time = parse_duration(time);
    return arguments;
}

std::optional<CheckArguments> parse_check(const Words& words) {
    Parser parser("lapidary check", "Lists all messages about a scene without rendering it.");
    CheckArguments arguments;
    SceneTexts scene;
    add_scene_options(parser.app(), scene, arguments.scene);
    parser.app().add_flag("--json", arguments.json, "Write them as JSON.");
    parser.app().add_flag("-s,--no-warnings", arguments.no_warnings, "Show errors only.");
    if (!parser.parse(words)) return std::nullopt;
    take_scene_texts(scene, arguments.scene);
    return arguments;
}

std::optional<PluginsArguments> parse_plugins(const Words& words) {
    Parser parser("lapidary plugins", "Lists the plugins found, and those refused with the reason.");
    std::vector<std::string> folders;
    add_plugin_path(parser.app(), folders);
    if (!parser.parse(words)) return std::nullopt;
    return PluginsArguments{split_folders(folders)};
}

std::optional<HelpArguments> parse_help(const Words& words) {
    Parser parser("lapidary help", "Explains a keyword of the scene language; without one, lists them.");
    std::vector<std::string> folders;
    std::string topic;
    add_plugin_path(parser.app(), folders);
    parser.app().add_option("keyword", topic, "sphere, png, union …")->type_name("");
    if (!parser.parse(words)) return std::nullopt;
    return HelpArguments{split_folders(folders), topic};
}

std::optional<CompareArguments> parse_compare(const Words& words) {
    Parser parser("lapidary compare", "Measures how far two pictures differ.");
    CompareArguments arguments;
    std::string first, second, difference;
    CLI::App& app = parser.app();
    app.add_option("a", first, "A picture.")->required()->type_name("");
    app.add_option("b", second, "Another one.")->required()->type_name("");
    const auto* const tolerance =
        app.add_option("--tolerance", arguments.tolerance, "How far a value may lie from the other one, 0 to 1.")
            ->type_name("T")
            ->check(at_least_zero());
    const auto* const share =
        app.add_option("--share", arguments.share, "Share of the pixels that may lie beyond the tolerance, 0 to 1.")
            ->type_name("S")
            ->check(number_that_is("from 0 to 1", [](double value) { return value >= 0 && value <= 1; }));
    app.add_option("--rmse", arguments.rmse,
                   "The largest root mean square error; without the two above, single pixels do not matter.")
        ->type_name("E")
        ->check(at_least_zero());
    app.add_option("--difference", difference, "Write a picture of the absolute differences.")->type_name("FILE");
    if (!parser.parse(words)) return std::nullopt;
    arguments.limits_pixels = tolerance->count() + share->count() > 0;
    arguments.first = first, arguments.second = second, arguments.difference = difference;
    return arguments;
}

std::optional<ConvergeArguments> parse_converge(const Words& words) {
    Parser parser("lapidary converge", "Measures whether pictures keep the error asked for, and what that costs.");
    ConvergeArguments arguments;
    SceneTexts scene;
    std::string name, resolution;
    CLI::App& app = parser.app();
    add_scene_options(app, scene, arguments.scene);
    app.add_option("-o,--output", name, "Name of table and chart; .csv and .svg are added.")->type_name("NAME");
    app.add_option("--errors", arguments.errors, "The errors to ask for, separated by commas.")
        ->type_name("E,E...")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->capture_default_str()
        ->check(possible_error());
    app.add_option("--resolution", resolution, "Pixels of the pictures; else 160 on their longer side.")->type_name("WxH");
    app.add_option("--reference-samples", arguments.reference_samples, "Rays a pixel of what is compared with.")
        ->type_name("N")
        ->capture_default_str()
        ->check(CLI::Range(2, 1 << 20));
    app.add_option("-j,--threads", arguments.threads, "Threads; 0: as many as the machine has.")
        ->type_name("N")
        ->check(CLI::Range(0, 4096));
    if (!parser.parse(words)) return std::nullopt;
    take_scene_texts(scene, arguments.scene);
    arguments.name = name;
    arguments.sized = !resolution.empty();
    if (arguments.sized) arguments.scene.settings.push_back(resolution_setting(resolution));
    return arguments;
}

}  // namespace lapidary
