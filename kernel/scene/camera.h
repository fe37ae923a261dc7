// SPDX-License-Identifier: MIT
//
// The camera as the scene describes it. Rays come from kernel/render/camera_rays.h.
#pragma once

#include <optional>

#include "kernel/math/vector.h"

namespace lapidary {

struct Camera {
    enum class Projection { perspective, orthographic };
    Projection projection = Projection::perspective;
    Point location{0, 0, 0};
    Vector up{0, 1, 0};
    double focus = 10;        // distance from the location, along the view, of the plane that is sharp; > 0
    double aperture = 0.2;    // lens diameter; 0: a pinhole
    int points = 1;           // lens points calculated beforehand, the first one the centre; 0: a new one for every ray
    std::optional<int> rays;  // rays a pixel; nothing: as many as the error asks for

    Point screen_centre{0, 0, 1};        // always set by the builder (look_at included)
    std::optional<double> screen_width;  // world units; nothing: by the resolution's aspect
    double screen_height = 1;            // world units; where screen_width is set and this is not given by the user,
    bool screen_height_given = false;    //   the height follows from the aspect
    std::optional<double> angle;         // horizontal field of view in radians, instead of the screen's size
};

}  // namespace lapidary
