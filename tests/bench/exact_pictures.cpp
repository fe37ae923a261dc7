// SPDX-License-Identifier: MIT
//
// Writes what a picture of scenes/precision must show, a byte a pixel from the top left: 0 the background, 1 and 2 the
// scene's colours, 255 where an edge passes within rounding of the pixel's middle.
//
//     lapidary_bench_exact_pictures flush 320 240 >flush.bytes

#include <cstdio>
#include <cstdlib>

#include "stress/exact_pictures.h"

int main(int count, char* words[]) {
    using namespace lapidary::test;
    if (count != 4) return std::fprintf(stderr, "usage: %s SCENE WIDTH HEIGHT\n", words[0]), 2;
    const int width = std::atoi(words[2]), height = std::atoi(words[3]);
    const ExactPicture picture(words[1], width, height);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const auto shown = picture.at(column, row);
            std::putchar(shown ? static_cast<int>(*shown) : 255);
        }
    return 0;
}
