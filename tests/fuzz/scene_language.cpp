// SPDX-License-Identifier: MIT
//
// libFuzzer's door to the scene loader: any bytes are a scene, and none of them may bring the program down.
#include <cstddef>
#include <cstdint>
#include <string>

#include "loaders/scene/load.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    lapidary::Messages messages;
    lapidary::LoadOptions options;
    options.max_items = 10'000;
    lapidary::load_scene_text("fuzz", std::string(reinterpret_cast<const char*>(data), size), options, messages);
    for (const lapidary::Message& message : messages.all()) static_cast<void>(message.format());
    return 0;
}
