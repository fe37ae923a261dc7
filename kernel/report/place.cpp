// SPDX-License-Identifier: MIT
#include "kernel/report/place.h"

#include <utility>

namespace lapidary {

const SourceFile& Sources::add(std::string name, std::string text, Place included_at) {
    return files_.emplace_back(SourceFile{std::move(name), std::move(text), included_at});
}

}  // namespace lapidary
