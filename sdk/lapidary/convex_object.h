// SPDX-License-Identifier: MIT
//
// The shortest way to a solid that every line meets in one piece at most: the author writes one scalar function,
//
//     Span span(const LocalLine& line) const;
//
// and gets both forms of Object::spans from it. Kept inline, the compiler turns the loop over the lines of a batch into vector
// instructions; early returns do not hinder it. (What is the same for all lines and takes a branch belongs to schema.derive().)
#pragma once

#include <type_traits>

#include "kernel/interfaces/object.h"
#include "kernel/math/roots.h"

namespace lapidary {

template <class Solid>
class ConvexObject : public Object {
public:
    int max_spans() const final { return 1; }

    int spans(const LocalLine& line, Span* out) const final {
        *out = solid().span(line);
        return solid().is_sheet() ? out->in <= out->out : out->in < out->out;
    }

    // All lanes are computed, whether asked for or not: a loop of constant length is what vectorises. `out` is promised to
    // overlap neither the solid nor the lines.
    void spans_batch(const LineBatch& lines, int, SpanBatch* __restrict out) const final {
        for (int lane = 0; lane < batch_size; ++lane) {
            const Span span = solid().span(lines.line(lane));
            out->in[lane] = span.in;
            out->out[lane] = span.out;
        }
    }

    void normals_batch(const PointBatch& points, int, NormalBatch* __restrict out) const final {
        for (int lane = 0; lane < batch_size; ++lane) {
            const Point point = points.point(lane);
            out->set(lane, solid().Solid::normal({point, face_of(point)}));
        }
    }

private:
    // A direct call, or none where the solid has one face only.
    int face_of(const Point& point) const {
        if constexpr (std::is_same_v<decltype(&Solid::face), decltype(&Object::face)>)
            return 0;
        else
            return solid().Solid::face(point);
    }

    const Solid& solid() const { return static_cast<const Solid&>(*this); }
};

}  // namespace lapidary
