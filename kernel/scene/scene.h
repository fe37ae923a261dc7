// SPDX-License-Identifier: MIT
//
// What the user described, looked up in the registry and checked: objects in CSG trees, materials, lights, camera,
// outputs. Immutable; nodes that the user named and used several times are shared.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/export.h"
#include "kernel/interfaces/light.h"
#include "kernel/interfaces/material.h"
#include "kernel/interfaces/object.h"
#include "kernel/interfaces/output.h"
#include "kernel/math/transform.h"
#include "kernel/report/place.h"
#include "kernel/scene/camera.h"

namespace lapidary {

class Plugin;  // kernel/registry/registry.h

struct SceneMaterial;
using SceneMaterialPtr = std::shared_ptr<const SceneMaterial>;

// A material as placed in the scene. Its space is the space of the node that carries it. It is one of
//   - a texture: `plugin` and `texture` are set, `children` fill its slots in order;
//   - a `material` block with a name or transform of its own, around the one child;
//   - the kernel's own plain matter: neither `texture` nor children.
struct SceneMaterial {
    MaterialPtr material;            // what the renderer asks: the texture with its transforms
    const Plugin* plugin = nullptr;  // of the outermost texture; null for the kernel's own plain matter
    std::string name;                // empty: none
    Place place;

    MaterialPtr texture;                     // as its plugin made it, without transforms
    std::vector<SceneMaterialPtr> children;  // in the order of writing
    std::vector<TransformFactor> factors;    // as written, for printing
    int depth = 1;                           // levels of nesting, this one included
};

enum class Operation : std::uint8_t { leaf, union_, merge, subtraction, intersection, symdiff };

struct SceneNode;
using SceneNodePtr = std::shared_ptr<const SceneNode>;

// A leaf of a CSG tree, or an operation on operands in the order of writing.
struct SceneNode {
    Operation operation = Operation::leaf;
    std::vector<SceneNodePtr> operands;  // none for a leaf

    std::shared_ptr<const Object> object;  // leaves only
    const Plugin* plugin = nullptr;

    std::vector<TransformFactor> factors;  // as written, for printing
    ExactTransform transform;              // their composition, from this node's space to its parent's
    SceneMaterialPtr material;             // null: none of its own
    std::optional<double> priority;
    std::string name;
    Place place;

    // Names can chain nodes a hundred thousand deep: released one after the other, not one inside the other.
    LAPIDARY_API ~SceneNode();
};

struct SceneLight {
    std::shared_ptr<const Light> light;  // already placed in the world
    const Plugin* plugin = nullptr;
    std::string name;
    Place place;
};

struct SceneOutput {
    std::shared_ptr<Output> output;
    const Plugin* plugin = nullptr;
    Place place;
};

struct OutputSettings {
    int width = 640, height = 480;
    std::string name;                     // empty: the scene's
    std::optional<std::string> encoding;  // the word of `encoding(linear);`, meant for every writer that has such a property
    std::vector<SceneOutput> writers;
};

struct RenderSettings {
    enum class Filter { box, gaussian, mitchell };
    int depth = 16;                       // reflections and refractions a path may have
    double cutoff = 1.0 / 1024;           // weight in the pixel below which a path ends
    double error = 0.004;                 // estimated error of a pixel at which adaptive sampling stops
    Filter filter = Filter::box;          // how a pixel weighs the light around its centre
    std::optional<double> filter_radius;  // in pixels; nothing: the filter's usual one
};

struct Scene {
    std::vector<std::filesystem::path> plugin_folders;  // of `plugins "folder";`, absolute
    std::shared_ptr<const Sources> sources;             // what the places point into
    SceneNodePtr root;                                  // a union of everything in the rendered `objects` block
    std::vector<SceneLight> lights;
    Colour background;
    Camera camera;
    OutputSettings output;
    RenderSettings render;
    std::string title;  // the scene file's stem
};

}  // namespace lapidary
