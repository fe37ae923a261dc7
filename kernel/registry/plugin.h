// SPDX-License-Identifier: MIT
//
// What a plugin's shared library exports: one descriptor, read before anything of the library is constructed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "kernel/interfaces/light.h"
#include "kernel/interfaces/object.h"
#include "kernel/interfaces/output.h"
#include "kernel/registry/schema.h"

namespace lapidary {

enum class PluginKind : std::uint32_t { object, material, light, output };

inline constexpr std::uint32_t plugin_magic = 0x4c415049;  // "LAPI"
// Counts up with every change of an interface that plugins are compiled against.
inline constexpr std::uint32_t plugin_interface_version = 5;

// What must agree between two compilations for objects to be passed between them: the standard library, and the sizes
// of what crosses the boundary. It reads "libstdc++ 8.32.88 …", so that a refusal can show both.
struct AbiTag {
    char text[96] = {};

    constexpr AbiTag() {
#if defined(_LIBCPP_VERSION)
        append("libc++");
#elif defined(_GLIBCXX_USE_CXX11_ABI) && _GLIBCXX_USE_CXX11_ABI
        append("libstdc++");
#else
        append("libstdc++ (before C++11)");
#endif
        char separator = ' ';
        for (std::size_t size : {sizeof(void*), sizeof(std::string), sizeof(std::function<void()>), sizeof(Value),
                                 sizeof(PropertySchema), sizeof(ChildSchema), sizeof(SchemaBase), sizeof(Span), sizeof(LineBatch),
                                 sizeof(Surface), sizeof(Matter), sizeof(Crossing), sizeof(Illumination), sizeof(FrameInfo)}) {
            append({&separator, 1});
            append(size);
            separator = '.';
        }
    }

private:
    std::size_t length_ = 0;

    constexpr void append(std::string_view part) {
        for (char c : part) text[length_++] = c;
    }
    constexpr void append(std::size_t number) {
        if (number >= 10) append(number / 10);
        text[length_++] = static_cast<char>('0' + number % 10);
    }
};

inline constexpr AbiTag plugin_abi_tag;

// Plain data, so that a library of any age can be asked what it is.
struct PluginDescriptor {
    std::uint32_t magic;
    std::uint32_t interface_version;
    const char* abi_tag;  // plugin_abi_tag.text of the library's compilation
    PluginKind kind;
    const SchemaBase& (*schema)();
    void* (*create)();  // a new default-constructed Object*, Material*, Light* or Output*
};

}  // namespace lapidary
