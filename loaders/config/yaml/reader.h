// SPDX-License-Identifier: MIT
//
// The one function of the module that reads configurations in YAML.
#pragma once

#include "kernel/report/messages.h"
#include "kernel/report/place.h"
#include "loaders/config/configuration.h"

namespace lapidary {

// Fills `configuration` from `source`; what is wrong with it goes to `messages`, with its place.
using ReadYamlConfiguration = void(const SourceFile& source, Configuration& configuration, Messages& messages);

inline constexpr const char* yaml_configuration_symbol = "lapidary_read_yaml_configuration";

}  // namespace lapidary
