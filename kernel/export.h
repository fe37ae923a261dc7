// SPDX-License-Identifier: MIT
//
// What the kernel's shared library shows to others; everything else stays hidden.
#pragma once

#define LAPIDARY_API __attribute__((visibility("default")))
