// SPDX-License-Identifier: MIT
//
// What holds for every object, whatever its shape: laws of spans, normals and faces, on random instances and random lines.

#include <algorithm>
#include <cmath>
#include <cstring>

#include "conformance/instances.h"
#include "kernel/interfaces/object.h"
#include "support/catch.h"

namespace lapidary::test {
namespace {

constexpr double u = 0x1p-53;
constexpr int instances_of_each = 30, lines_of_each = 60;

// An instance and the size of the part of it that lines are aimed at.
struct Specimen {
    std::unique_ptr<Object> object;
    Point low, high;
    double size;
};

Specimen make_specimen(const Plugin& plugin, Random& random) {
    Specimen s{random_object(plugin, random), {}, {}, 0};
    const Bounds bounds = s.object->bounds();
    for (double end : {bounds.low.x, bounds.low.y, bounds.low.z, bounds.high.x, bounds.high.y, bounds.high.z})
        if (std::isfinite(end)) s.size = std::max(s.size, std::fabs(end));
    if (s.size == 0) s.size = 1;
    // An infinite solid is looked at near its centre.
    const auto clip = [&](double end) { return std::isfinite(end) ? end : std::copysign(s.size, end); };
    s.low = {clip(bounds.low.x), clip(bounds.low.y), clip(bounds.low.z)};
    s.high = {clip(bounds.high.x), clip(bounds.high.y), clip(bounds.high.z)};
    return s;
}

// The line through a point, about its own point closest to the origin.
LocalLine line_through(const Point& p, const Vector& direction) {
    const double a = dot(direction, direction);
    const LocalLine rough{LocalLine{p, direction}.at(-dot(p, direction) / a), direction};
    return {rough.at(-dot(rough.closest, direction) / a), direction};
}

// Through a random point of the box around the solid; now and then along or across an axis.
LocalLine random_line(const Specimen& s, Random& random) {
    const Point p{random.uniform(1.05 * s.low.x, 1.05 * s.high.x), random.uniform(1.05 * s.low.y, 1.05 * s.high.y),
                  random.uniform(1.05 * s.low.z, 1.05 * s.high.z)};
    Vector d = random.direction();
    const int kind = random.below(8);
    if (kind == 0) d.x = 0;
    if (kind == 1) d.y = 0;
    if (kind == 2) d.z = -0.0;
    if (kind == 3) d = {0, random.uniform(0, 1) < 0.5 ? 1.0 : -1.0, 0};
    if (kind == 4) d = {random.uniform(0, 1) < 0.5 ? 1.0 : -1.0, -0.0, 0};
    return line_through(p, random.magnitude(-3, 3) * d);
}

template <class F>
void for_every_object(unsigned seed, F check) {
    Random random(seed);
    for (const std::string& keyword : registry().keywords(PluginKind::object)) {
        const Plugin& p = plugin(PluginKind::object, keyword);
        for (int i = 0; i < instances_of_each; ++i) {
            const Specimen specimen = make_specimen(p, random);
            CAPTURE(keyword, describe(dynamic_cast<const void*>(specimen.object.get()), p.schema()));
            check(specimen, random);
        }
    }
}

template <class F>
void for_every_line(unsigned seed, F check) {
    for_every_object(seed, [&](const Specimen& specimen, Random& random) {
        for (int i = 0; i < lines_of_each; ++i) {
            const LocalLine line = random_line(specimen, random);
            CAPTURE(line.closest.x, line.closest.y, line.closest.z, line.direction.x, line.direction.y, line.direction.z);
            check(specimen, line);
        }
    });
}

std::vector<Span> spans_of(const Object& object, const LocalLine& line) {
    std::vector<Span> spans(static_cast<std::size_t>(object.max_spans()));
    const int count = object.spans(line, spans.data());
    REQUIRE(count >= 0);
    REQUIRE(count <= object.max_spans());
    spans.resize(static_cast<std::size_t>(count));
    return spans;
}

// How far a point lies outside of a surface, negative inside; near the surface, its distance.
double outside(const Surface& s, const Point& p) {
    const double rho = std::hypot(p.x, p.z);
    switch (s.kind) {
        case Surface::Kind::plane:
            return (s.a * p.x + s.b * p.y + s.c * p.z - s.d) / std::hypot(s.a, s.b, s.c);
        case Surface::Kind::sphere:
            return std::hypot(p.x, p.y, p.z) - s.a;
        case Surface::Kind::cylinder:
            return rho - s.a;
        case Surface::Kind::cone:
            return (rho - std::fabs(s.a * (s.b - p.y))) / std::hypot(1, s.a);
        case Surface::Kind::torus:
            return std::hypot(rho - s.a, p.y) - s.b;
    }
    return infinity;
}

double outside(const Surfaces& surfaces, const Point& p) {
    double farthest = -infinity;
    for (const Surface& s : surfaces) farthest = std::max(farthest, outside(s, p));
    return farthest;
}

// A distance that is rounding for a place on the line within this instance.
double rounding(const Specimen& s, const LocalLine& line, double t) {
    return 64 * u * (s.size + std::hypot(line.closest.x, line.closest.y, line.closest.z) + std::fabs(t) * length(line.direction));
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace

TEST_CASE("spans are sorted, disjoint, and none is empty") {
    for_every_line(1, [](const Specimen& s, const LocalLine& line) {
        const auto spans = spans_of(*s.object, line);
        for (std::size_t i = 0; i < spans.size(); ++i) {
            if (s.object->is_sheet())
                CHECK((spans[i].in == spans[i].out && std::isfinite(spans[i].in)));
            else
                CHECK(spans[i].in < spans[i].out);
            if (i > 0) CHECK(spans[i - 1].out < spans[i].in);
        }
    });
}

TEST_CASE("spans lie within the bounds") {
    for_every_line(2, [](const Specimen& s, const LocalLine& line) {
        const Bounds bounds = s.object->bounds();
        for (const Span& span : spans_of(*s.object, line))
            for (double t : {span.in, span.out}) {
                if (!std::isfinite(t)) {
                    CHECK_FALSE(bounds.is_finite());
                    continue;
                }
                const Point p = line.at(t);
                const double r = rounding(s, line, t);
                CHECK((p.x >= bounds.low.x - r && p.y >= bounds.low.y - r && p.z >= bounds.low.z - r));
                CHECK((p.x <= bounds.high.x + r && p.y <= bounds.high.y + r && p.z <= bounds.high.z + r));
            }
    });
}

TEST_CASE("spans are where the line is inside of all surfaces") {
    for_every_line(3, [](const Specimen& s, const LocalLine& line) {
        const Surfaces surfaces = s.object->surfaces();
        if (surfaces.empty()) return;
        const double reach = 4 * s.size / length(line.direction);
        double before = -reach;
        const auto check_gap = [&](double from, double to) {
            if (!(from < to)) return;
            const double middle = from + (to - from) / 2;
            CHECK(outside(surfaces, line.at(middle)) > -rounding(s, line, middle));
        };
        for (const Span& span : spans_of(*s.object, line)) {
            for (double t : {span.in, span.out})
                if (std::isfinite(t)) CHECK(std::fabs(outside(surfaces, line.at(t))) <= rounding(s, line, t));
            check_gap(before, span.in);
            if (!s.object->is_sheet()) {
                const double middle = std::max(span.in, -reach) / 2 + std::min(span.out, reach) / 2;
                if (middle > span.in && middle < span.out) CHECK(outside(surfaces, line.at(middle)) < rounding(s, line, middle));
            }
            before = span.out;
        }
        check_gap(before, reach);
    });
}

TEST_CASE("a batch gives the same bits as one line at a time") {
    for_every_object(4, [](const Specimen& s, Random& random) {
        for (int repetition = 0; repetition < lines_of_each / batch_size; ++repetition) {
            LineBatch lines{};
            for (int lane = 0; lane < batch_size; ++lane) {
                const LocalLine line = random_line(s, random);
                lines.closest_x[lane] = line.closest.x, lines.direction_x[lane] = line.direction.x;
                lines.closest_y[lane] = line.closest.y, lines.direction_y[lane] = line.direction.y;
                lines.closest_z[lane] = line.closest.z, lines.direction_z[lane] = line.direction.z;
            }
            std::vector<SpanBatch> found(static_cast<std::size_t>(s.object->max_spans()));
            const int count = 1 + random.below(batch_size);
            s.object->spans_batch(lines, count, found.data());
            for (int lane = 0; lane < count; ++lane) {
                const auto spans = spans_of(*s.object, lines.line(lane));
                for (std::size_t rank = 0; rank < found.size(); ++rank) {
                    const double in = found[rank].in[lane], out = found[rank].out[lane];
                    if (rank < spans.size())
                        CHECK((same_bits(in, spans[rank].in) && same_bits(out, spans[rank].out)));
                    else
                        CHECK((s.object->is_sheet() ? !(in <= out) : !(in < out)));
                }
            }
        }
    });
}

TEST_CASE("normals point outward") {
    for_every_line(5, [](const Specimen& s, const LocalLine& line) {
        if (s.object->is_sheet()) return;
        for (const Span& span : spans_of(*s.object, line))
            for (double t : {span.in, span.out}) {
                if (!std::isfinite(t)) continue;
                const Point p = line.at(t);
                const Normal n = normalize(s.object->normal({p, s.object->face(p)}));
                CHECK(length(to_vector(n)) == Approx(1));
                const double across = dot(n, line.direction) / length(line.direction);
                // A chord of rounding length, at an edge or at a tangency, may see either side.
                if ((span.out - span.in) * length(line.direction) < 1e-6 * s.size) continue;
                if (t == span.in)
                    CHECK(across <= 1e-6);
                else
                    CHECK(across >= -1e-6);
            }
    });
}

TEST_CASE("normals stand on the surface") {
    for_every_line(6, [](const Specimen& s, const LocalLine& line) {
        // A second line a little beside meets the surface at a point that lies in the tangent plane, but for the
        // curvature: its distance from the plane is of second order.
        const Vector aside = normalize(cross(line.direction, Vector{0.36, 0.48, 0.8}));
        const LocalLine beside = line_through(line.closest + 1e-6 * s.size * aside, line.direction);
        const auto spans = spans_of(*s.object, line), others = spans_of(*s.object, beside);
        if (others.size() != spans.size()) return;
        for (std::size_t i = 0; i < spans.size(); ++i) {
            if (!std::isfinite(spans[i].in) || !std::isfinite(others[i].in)) continue;
            const Point p = line.at(spans[i].in), q = beside.at(others[i].in);
            const int face = s.object->face(p);
            const double moved = length(q - p);
            // Around a corner or at a grazing angle there is no first order to speak of.
            if (s.object->face(q) != face || moved > 1e-4 * s.size) continue;
            const Normal n = normalize(s.object->normal({p, face}));
            CHECK(std::fabs(dot(n, q - p)) <= 1e-2 * moved + rounding(s, line, spans[i].in));
        }
    });
}

TEST_CASE("a reversed line has the same spans, mirrored") {
    for_every_line(7, [](const Specimen& s, const LocalLine& line) {
        const auto forward = spans_of(*s.object, line);
        auto backward = spans_of(*s.object, {line.closest, -line.direction});
        std::reverse(backward.begin(), backward.end());
        REQUIRE(forward.size() == backward.size());
        const auto agree = [](double a, double b) { return a == b || std::fabs(a - b) <= 1e-11 * (std::fabs(a) + std::fabs(b)); };
        for (std::size_t i = 0; i < forward.size(); ++i) {
            CHECK(agree(forward[i].in, -backward[i].out));
            CHECK(agree(forward[i].out, -backward[i].in));
        }
    });
}

TEST_CASE("a direction twice as long halves every t, exactly") {
    for_every_line(8, [](const Specimen& s, const LocalLine& line) {
        const auto once = spans_of(*s.object, line);
        for (double factor : {2.0, 0x1p-300, 0x1p200}) {
            const auto stretched = spans_of(*s.object, {line.closest, factor * line.direction});
            REQUIRE(once.size() == stretched.size());
            for (std::size_t i = 0; i < once.size(); ++i) {
                CHECK(stretched[i].in == once[i].in / factor);
                CHECK(stretched[i].out == once[i].out / factor);
            }
        }
    });
}

TEST_CASE("the face of a point is that of the nearest surface") {
    for_every_line(9, [](const Specimen& s, const LocalLine& line) {
        const Surfaces surfaces = s.object->surfaces();
        for (const Span& span : spans_of(*s.object, line))
            for (double t : {span.in, span.out}) {
                if (!std::isfinite(t)) continue;
                const Point p = line.at(t);
                const int face = s.object->face(p);
                REQUIRE(face >= 0);
                if (surfaces.empty()) continue;
                REQUIRE(face < static_cast<int>(surfaces.size()));
                CHECK(std::fabs(outside(surfaces[static_cast<std::size_t>(face)], p)) <= rounding(s, line, t));
            }
    });
}

TEST_CASE("no line and no instance gives a NaN") {
    for_every_object(10, [](const Specimen& s, Random& random) {
        const double extremes[] = {0, -0.0, 0x1p-1074, -1e-310, 1e-150, 1, -1e100, 1e150, 1e300};
        const auto any = [&] { return extremes[random.below(static_cast<int>(std::size(extremes)))]; };
        for (int i = 0; i < 4 * lines_of_each; ++i) {
            const LocalLine line{{any(), any(), any()}, {any(), any(), any()}};
            CAPTURE(line.closest.x, line.closest.y, line.closest.z, line.direction.x, line.direction.y, line.direction.z);
            for (const Span& span : spans_of(*s.object, line)) CHECK((s.object->is_sheet() || span.in < span.out));
        }
    });
}

}  // namespace lapidary::test
