// SPDX-License-Identifier: MIT
//
// What a plugin's shared library exports: one descriptor, read before anything of the library is constructed.
#pragma once

#include <cstdint>

#include "kernel/registry/schema.h"

namespace lapidary {

enum class PluginKind : std::uint32_t { object, material, light, output };

inline constexpr std::uint32_t plugin_magic = 0x4c415049;  // "LAPI"
// Counts up with every change of an interface that plugins are compiled against.
inline constexpr std::uint32_t plugin_interface_version = 1;

// Plain data, so that a library of any age can be asked what it is.
struct PluginDescriptor {
    std::uint32_t magic;
    std::uint32_t interface_version;
    const char* abi_tag;  // compiler ABI: libstdc++ or libc++, sizes that matter
    PluginKind kind;
    const SchemaBase& (*schema)();
    void* (*create)();  // a new default-constructed Object*, Material*, Light* or Output*
};

}  // namespace lapidary
