// SPDX-License-Identifier: MIT
//
// What `lapidary help sphere` shows: a plugin's schema as text.
#pragma once

#include <string>

#include "kernel/export.h"
#include "kernel/registry/registry.h"

namespace lapidary {

//     torus: A ring.
//
//       radii(R, r)   length, above 0; (1, 0.25) unless given
//                     Of the ring and of its tube.
//
//     Conditions:
//       the tube must be thinner than the ring
//
//     object, from /usr/lib/lapidary/plugins/objects/torus.so
LAPIDARY_API std::string help_text(const Plugin& plugin);

// The part of it that the schema alone knows: everything but the last line.
LAPIDARY_API std::string help_text(const SchemaBase& schema, const std::string& keyword);

// What a property takes: "length, above 0", "a colour", "perspective or orthographic".
LAPIDARY_API std::string describe_values(const PropertySchema& property);

}  // namespace lapidary
