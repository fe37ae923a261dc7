// SPDX-License-Identifier: MIT
//
// The one include of a plugin, and the one macro, on its last line:
//
//     class Sphere final : public ConvexObject<Sphere> {
//     public:
//         static void describe(Schema<Sphere>& schema) { … }
//         …
//     };
//
//     LAPIDARY_PLUGIN(Sphere)
//
// A plugin is a class that is default-constructible, derives from one of Object, Material, Light and Output, and
// describes its properties. The kind follows from the interface, the keyword from the file's name, and everything that
// the user may write about it from `describe`.
//
// What the library exports is one PluginDescriptor called `lapidary_plugin`. Its `create` gives the address of the
// interface (Object*, Material* …) as void*; the functions of its schema take the address of the most derived object,
// which dynamic_cast<void*>(interface) finds. The object is destroyed through the interface's virtual destructor.
#pragma once

#include <type_traits>

#include "kernel/interfaces/light.h"
#include "kernel/interfaces/material.h"
#include "kernel/interfaces/object.h"
#include "kernel/interfaces/output.h"
#include "kernel/registry/plugin.h"
#include "kernel/registry/schema.h"

// What the SDK adds to the interfaces: one scalar function becomes all of an object's; slots for child textures; the
// properties common to all leaves of texture trees; noise.
#include "lapidary/child.h"
#include "lapidary/convex_object.h"
#include "lapidary/leaf.h"
#include "lapidary/noise.h"
#include "lapidary/selection.h"

namespace lapidary::sdk {

template <class T, class Interface>
inline constexpr bool implements = std::is_base_of_v<Interface, T>;

template <class T>
constexpr PluginKind kind_of() {
    static_assert(implements<T, Object> + implements<T, Material> + implements<T, Light> + implements<T, Output> == 1,
                  "a plugin derives from exactly one of Object, Material, Light and Output");
    if constexpr (implements<T, Object>) return PluginKind::object;
    if constexpr (implements<T, Material>) return PluginKind::material;
    if constexpr (implements<T, Light>) return PluginKind::light;
    return PluginKind::output;
}

template <class T>
using InterfaceOf = std::conditional_t<
    implements<T, Object>, Object,
    std::conditional_t<implements<T, Material>, Material, std::conditional_t<implements<T, Light>, Light, Output>>>;

// Hidden even where a library is built with everything visible: the dynamic linker would merge the static schemas of
// two plugins whose classes have the same name.
template <class T>
[[gnu::visibility("hidden")]] const SchemaBase& schema_of() {
    static const Schema<T> schema;
    return schema;
}

template <class T>
void* create() {
    return static_cast<InterfaceOf<T>*>(new T);
}

template <class T>
constexpr PluginDescriptor describe_plugin() {
    return {plugin_magic, plugin_interface_version, plugin_abi_tag.text, kind_of<T>(), &schema_of<T>, &create<T>};
}

}  // namespace lapidary::sdk

#define LAPIDARY_PLUGIN(Class)                                                                                \
    extern "C" {                                                                                              \
    LAPIDARY_API extern const ::lapidary::PluginDescriptor lapidary_plugin;                                   \
    constinit const ::lapidary::PluginDescriptor lapidary_plugin = ::lapidary::sdk::describe_plugin<Class>(); \
    }
