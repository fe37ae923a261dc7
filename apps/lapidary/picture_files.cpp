// SPDX-License-Identifier: MIT
#include "apps/lapidary/picture_files.h"

#include <algorithm>
#include <optional>

namespace lapidary {

namespace {

namespace fs = std::filesystem;

constexpr const char* default_format = "png";

class Chooser {
public:
    Chooser(const Scene& scene, Registry& registry, const OutputChoice& choice, Messages& messages)
        : scene_(scene), registry_(registry), choice_(choice), messages_(messages) {}

    std::vector<PictureFile> choose() {
        if (!choice_.formats.empty()) {
            for (const std::string& format : choice_.formats) add_format(format);
        } else if (const auto format = format_of(choice_.name)) {
            add_format(*format);
        } else if (writes_files(scene_.output.writers)) {
            for (const SceneOutput& writer : scene_.output.writers)
                if (is_writer(writer)) files_.push_back({writer.output, writer.plugin, {}});
        } else {
            add_format(format_of(scene_.output.name).value_or(default_format));
        }
        name_files();
        // Outputs without a file, such as a window, do not compete with those that write.
        for (const SceneOutput& writer : scene_.output.writers)
            if (!is_writer(writer)) files_.push_back({writer.output, writer.plugin, {}});
        return std::move(files_);
    }

private:
    static bool is_writer(const SceneOutput& output) { return !output.output->extensions().empty(); }
    static bool writes_files(const std::vector<SceneOutput>& outputs) { return std::ranges::any_of(outputs, is_writer); }

    // The keyword of the output that writes files of this name's extension.
    std::optional<std::string> format_of(const fs::path& name) {
        const std::string extension = extension_of(name);
        if (extension.empty()) return std::nullopt;
        for (const SceneOutput& writer : scene_.output.writers)
            if (writes(*writer.output, extension)) return writer.plugin->keyword();
        // Nearly always the extension is the keyword; only for the others all outputs are opened and asked.
        std::vector<std::string> keywords = registry_.keywords(PluginKind::output);
        if (std::ranges::find(keywords, extension) != keywords.end()) keywords = {extension};
        for (const std::string& keyword : keywords) {
            std::string reason;
            const Plugin* const plugin = registry_.find(PluginKind::output, keyword, reason);
            if (plugin && writes(*plugin->create_output(), extension)) return keyword;
        }
        return std::nullopt;
    }

    void add_format(const std::string& keyword) {
        for (const SceneOutput& writer : scene_.output.writers)
            if (writer.plugin->keyword() == keyword) return files_.push_back({writer.output, writer.plugin, {}});
        std::string reason;
        const Plugin* const plugin = registry_.find(PluginKind::output, keyword, reason);
        if (plugin) return files_.push_back({create(*plugin), plugin, {}});
        if (reason.empty()) {
            reason = "there is no output '" + keyword + "' in";
            for (const fs::path& folder : registry_.search_path()) reason += " " + folder.string();
        }
        messages_.error({}, reason + "; lapidary plugins lists what there is");
    }

    // A writer that the scene does not name; what the output block says for all of them holds for it.
    std::shared_ptr<Output> create(const Plugin& plugin) const {
        std::shared_ptr<Output> output = plugin.create_output();
        const PropertySchema* const encoding = plugin.schema().find("encoding");
        if (encoding && scene_.output.encoding)
            encoding->assign(dynamic_cast<void*>(output.get()), {word_value(*scene_.output.encoding)});
        return output;
    }

    void name_files() {
        for (PictureFile& file : files_) file.path = name_for(file);
        for (std::size_t i = 0; i < files_.size(); ++i)
            for (std::size_t k = 0; k < i; ++k)
                if (files_[i].path == files_[k].path)
                    messages_.error({}, "two writers would write '" + files_[i].path.string() +
                                            "'; leave one of them out of the output block");
    }

    fs::path name_for(const PictureFile& file) {
        const bool by_option = !choice_.name.empty();
        const fs::path name = by_option ? choice_.name : fs::path(scene_.output.name.empty() ? scene_.title : scene_.output.name);
        // A device is what it is, whatever the format.
        std::error_code error;
        if (by_option && fs::exists(name, error) && !fs::is_regular_file(name, error)) return name;
        const std::vector<std::string> extensions = file.output->extensions();
        if (std::ranges::find(extensions, extension_of(name)) != extensions.end()) return name;
        fs::path named = format_of(name) ? fs::path(name).replace_extension() : name;
        return named += "." + (extensions.empty() ? file.plugin->keyword() : extensions.front());
    }

    static bool writes(const Output& output, const std::string& extension) {
        const std::vector<std::string> extensions = output.extensions();
        return std::ranges::find(extensions, extension) != extensions.end();
    }

    // Without dot, lower case.
    static std::string extension_of(const fs::path& name) {
        std::string extension = name.extension().string();
        if (!extension.empty()) extension.erase(0, 1);
        std::ranges::transform(extension, extension.begin(),
                               [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
        return extension;
    }

    const Scene& scene_;
    Registry& registry_;
    const OutputChoice& choice_;
    Messages& messages_;
    std::vector<PictureFile> files_;
};

}  // namespace

std::vector<PictureFile> choose_pictures(const Scene& scene, Registry& registry, const OutputChoice& choice, Messages& messages) {
    return Chooser(scene, registry, choice, messages).choose();
}

}  // namespace lapidary
