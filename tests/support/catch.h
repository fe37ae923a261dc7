// SPDX-License-Identifier: MIT
//
// The one place that knows which Catch2 is installed: 2.13 has a single header, 3 has one per topic.
#pragma once

#if defined(LAPIDARY_CATCH2_VERSION) && LAPIDARY_CATCH2_VERSION >= 3
#include <catch2/catch_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>
#endif
