// SPDX-License-Identifier: MIT
//
// Anchors the vtable of Object in the kernel and answers for objects that leave the optional questions open.
#include "kernel/interfaces/object.h"

#include <cstddef>

namespace lapidary {

Object::~Object() = default;

void Object::spans_batch(const LineBatch& lines, int count, SpanBatch* out) const {
    const int ranks = max_spans();
    std::vector<Span> found(static_cast<std::size_t>(ranks));
    for (int lane = 0; lane < count; ++lane) {
        const int n = spans(lines.line(lane), found.data());
        for (int rank = 0; rank < ranks; ++rank) {
            const Span span = rank < n ? found[static_cast<std::size_t>(rank)] : Span::none();
            out[rank].in[lane] = span.in;
            out[rank].out[lane] = span.out;
        }
    }
}

void Object::normals_batch(const PointBatch& points, int count, NormalBatch* out) const {
    for (int lane = 0; lane < count; ++lane) {
        const Point point = points.point(lane);
        out->set(lane, normal({point, face(point)}));
    }
}

int Object::face(const Point&) const { return 0; }

Surfaces Object::surfaces() const { return {}; }

}  // namespace lapidary
