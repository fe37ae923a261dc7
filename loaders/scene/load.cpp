// SPDX-License-Identifier: MIT
#include "loaders/scene/load.h"

#include <utility>

#include "kernel/math/standard_arithmetic.h"
#include "loaders/scene/files.h"
#include "loaders/scene/loading.h"
#include "loaders/scene/parser.h"

namespace lapidary {

Document load_scene_file(const std::filesystem::path& file, const LoadOptions& options, Messages& messages) {
    scene_language::FileText text = scene_language::read_file(file);
    if (text.failure.empty()) return load_scene_text(file.string(), std::move(text.text), options, messages);
    messages.error({}, text.failure);
    return {};
}

Document load_scene_text(std::string name, std::string text, const LoadOptions& options, Messages& messages) {
    const StandardArithmetic standard;
    Document document;
    const SourceFile& file = document.sources->add(std::move(name), scene_language::without_byte_order_mark(std::move(text)));

    scene_language::Loading loading{options, messages, *document.sources};
    loading.include_chain.push_back(scene_language::identity_of(file.name));
    scene_language::Parser(file, loading).parse(document.items);
    loading.warn_unused_since(0);
    document.constants = loading.constants.name_list();
    return document;
}

}  // namespace lapidary
