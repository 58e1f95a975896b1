// Markers and grid: interpolation and spreading, exact adjoints.
//
// In spreading every thread adds only to the planes it owns, so no two threads touch a value and the order of
// a sum is fixed.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cstdint>

#include "rdpm/fluid/momentum.hpp"
#include "rdpm/particles/marker_stencils.hpp"

namespace rdpm {

// What moving walls add to the interpolated component: the folded weights times the walls' speed.
inline double wall_part(const Grid& g, const FoldedStencils& s, int component) {
    double sum = 0.0;
    for (int d = 0; d < 3; ++d)
        if (d != component)
            for (int side = 0; side < 2; ++side)
                if (s.centre_of[d].wall[side] != 0.0)
                    sum += s.centre_of[d].wall[side] * g.speed_of_side(2 * d + side, component);
    return sum;
}

inline double interpolate_folded(const Grid& g, const double* q, const FoldedStencils& s, int component) {
    const Stencil &x = s.along(0, component), &y = s.along(1, component), &z = s.along(2, component);
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
        double in_plane = 0.0;
        const double* plane = q + z.index[c] * g.plane();
        for (int b = 0; b < 3; ++b) {
            const double* r = plane + y.index[b] * g.row();
            in_plane += y.weight[b] * (x.weight[0] * r[x.index[0]] + x.weight[1] * r[x.index[1]] +
                                       x.weight[2] * r[x.index[2]]);
        }
        sum += z.weight[c] * in_plane;
    }
    return sum + wall_part(g, s, component);
}

inline void interpolate_wrapped(const Grid& g, const VelocityArrays& q, const InnerMarker& m,
                                const Weights& weights, int n, double* out) {
    const double* field[3] = {q.u, q.v, q.w};
    int nearest[3];
    nearest_centre(g, m, nearest);
    for (int component = 0; component < 3; ++component) {
        const WrappedPoints at(g, m, nearest, component);
        const PointWeights w(weights, component, n);
        Four sum{};
        for (int c = 0; c < 3; ++c)
            for (int b = 0; b < 3; ++b) {
                const double* r = field[component] + at.row[c][b];
                sum += w.z[c] * w.y[b] *
                       (at.is_whole ? *reinterpret_cast<const Four*>(r + at.x[0])
                                    : Four{r[at.x[0]], r[at.x[1]], r[at.x[2]], 0.0});
            }
        out[component] = w.x[0] * sum[0] + w.x[1] * sum[1] + w.x[2] * sum[2];
    }
}

// What a marker soon to come will read first: the planes below it are in cache already. Both ends of a row's
// points, for these may lie in two lines. Inlined always: a call that only prefetches is removed as one
// without effect.
constexpr int prefetch_ahead = 16;

[[gnu::always_inline]] inline void prefetch(const VelocityArrays& q, std::size_t row, std::size_t plane,
                                            const InnerMarker& m) {
    if (m.is_wrapped()) return;
    for (const double* field : {q.u, q.v, q.w}) {
        const double* p = field + m.first + 2 * plane;
        for (int b = 0; b < 3; ++b, p += row) {
            __builtin_prefetch(p - 1);
            __builtin_prefetch(p + 3);
        }
    }
}

// Known at compile time which direction is on faces: the 27 terms unroll.
template <int component>
inline double interpolate_inner(std::size_t row, std::size_t plane, const double* q, const InnerMarker& m,
                                const Weights& weights, int n) {
    constexpr int x = weights_along<component>(0), y = weights_along<component>(1),
                  z = weights_along<component>(2);
    const double* p = q + first_point<component>(m, row, plane);
    const double y_low = weights.low[y + n], y_middle = weights.middle[y + n], y_high = weights.high[y + n];
    const auto in_plane = [&](const double* r) {
        const auto at = [](const double* value) { return *reinterpret_cast<const Four*>(value); };
        return y_low * at(r) + y_middle * at(r + row) + y_high * at(r + 2 * row);
    };
    const Four sum = weights.low[z + n] * in_plane(p) + weights.middle[z + n] * in_plane(p + plane) +
                     weights.high[z + n] * in_plane(p + 2 * plane);
    return weights.low[x + n] * sum[0] + weights.middle[x + n] * sum[1] + weights.high[x + n] * sum[2];
}

// Velocity at the markers, (markers, 3).
inline void interpolate(const Grid& g, const VelocityArrays& q, const StencilSet& set, double* out) {
    const double* field[3] = {q.u, q.v, q.w};
    const std::size_t row = g.row(), plane = g.plane();
    const int inner = set.count_inner(), folded = static_cast<int>(set.folded.size());
#pragma omp parallel num_threads(g.threads) if (set.count() > 256)
    {
#pragma omp for schedule(static) nowait
        for (int begin = 0; begin < inner; begin += Weights::most) {
            const InnerMarker* marker = set.inner.data() + begin;
            const int count = std::min(Weights::most, inner - begin);
            Weights weights;
            weights.find(marker, count);
            for (int n = 0; n < count; ++n) {
                prefetch(q, row, plane, set.inner[std::min(begin + n + prefetch_ahead, inner - 1)]);
                double* value = out + 3 * marker[n].marker;
                if (marker[n].is_wrapped()) {
                    interpolate_wrapped(g, q, marker[n], weights, n, value);
                    continue;
                }
                value[0] = interpolate_inner<0>(row, plane, q.u, marker[n], weights, n);
                value[1] = interpolate_inner<1>(row, plane, q.v, marker[n], weights, n);
                value[2] = interpolate_inner<2>(row, plane, q.w, marker[n], weights, n);
            }
        }
#pragma omp for schedule(static)
        for (int n = 0; n < folded; ++n)
            for (int c = 0; c < 3; ++c)
                out[3 * set.folded[n].marker + c] = interpolate_folded(g, field[c], set.folded[n], c);
    }
}

// One marker's share in the planes [first, last).
inline void spread_folded(const Grid& g, double* q, const FoldedStencils& s, int component, double strength,
                          int first, int last) {
    const Stencil &x = s.along(0, component), &y = s.along(1, component), &z = s.along(2, component);
    for (int c = 0; c < 3; ++c) {
        if (z.index[c] < first || z.index[c] >= last) continue;
        for (int b = 0; b < 3; ++b) {
            double* r = q + z.index[c] * g.plane() + y.index[b] * g.row();
            const double f = strength * z.weight[c] * y.weight[b];
            for (int a = 0; a < 3; ++a) r[x.index[a]] += f * x.weight[a];
        }
    }
}

// `lowest`: plane of the first of the marker's centres.
template <int component, bool bounded>
inline void spread_inner(std::size_t row, std::size_t plane, double* q, const InnerMarker& m,
                         const Weights& weights, int n, double strength, int lowest, int first, int last) {
    constexpr int x = weights_along<component>(0), y = weights_along<component>(1),
                  z = weights_along<component>(2);
    const Four along_x = strength * Four{weights.low[x + n], weights.middle[x + n], weights.high[x + n], 0.0};
    double* p = q + first_point<component>(m, row, plane);
    if (component == face_z) lowest -= std::signbit(m.from_centre[2]);
    const double in_z[3] = {weights.low[z + n], weights.middle[z + n], weights.high[z + n]};
    const double y_low = weights.low[y + n], y_middle = weights.middle[y + n], y_high = weights.high[y + n];
    const auto at = [](double* r) -> Four& { return *reinterpret_cast<Four*>(r); };
    for (int c = 0; c < 3; ++c, p += plane) {
        if (bounded && (lowest + c < first || lowest + c >= last)) continue;
        const Four f = in_z[c] * along_x;
        at(p) += y_low * f;
        at(p + row) += y_middle * f;
        at(p + 2 * row) += y_high * f;
    }
}

// What a marker gives to the planes [first, last).
inline void spread_wrapped(const Grid& g, const VelocityArrays& q, const InnerMarker& m,
                           const Weights& weights, int n, const double* value, double strength, int first,
                           int last) {
    double* field[3] = {q.u, q.v, q.w};
    int nearest[3];
    nearest_centre(g, m, nearest);
    for (int component = 0; component < 3; ++component) {
        const WrappedPoints at(g, m, nearest, component);
        const PointWeights w(weights, component, n);
        const Four along_x = strength * value[component] * Four{w.x[0], w.x[1], w.x[2], 0.0};
        for (int c = 0; c < 3; ++c) {
            if (at.plane[c] < first || at.plane[c] >= last) continue;
            for (int b = 0; b < 3; ++b) {
                double* r = field[component] + at.row[c][b];
                const Four f = w.z[c] * w.y[b] * along_x;
                if (at.is_whole)
                    *reinterpret_cast<Four*>(r + at.x[0]) += f;
                else
                    for (int a = 0; a < 3; ++a) r[at.x[a]] += f[a];
            }
        }
    }
}

struct Source {
    const double *value, *volume;  // (markers, 3), (markers)
    double factor;

    [[gnu::always_inline]] void prefetch(int marker) const {
        __builtin_prefetch(value + 3 * marker);
        __builtin_prefetch(value + 3 * marker + 2);
        __builtin_prefetch(volume + marker);
    }
};

// What the inner markers whose nearest centre is in plane k give to the planes [first, last).
template <bool bounded>
inline void spread_from_plane(const Grid& g, const VelocityArrays& q, const StencilSet& set,
                              const Source& source, int k, int first, int last) {
    const std::size_t row = g.row(), plane = g.plane();
    for (int begin = set.begin_of(g, k), end = set.begin_of(g, k + 1); begin < end; begin += Weights::most) {
        const InnerMarker* marker = set.inner.data() + begin;
        const int count = std::min(Weights::most, end - begin);
        Weights weights;
        weights.find(marker, count);
        for (int n = 0; n < count; ++n) {
            const InnerMarker& m = marker[n];
            const InnerMarker& later = set.inner[std::min(begin + n + prefetch_ahead, set.count_inner() - 1)];
            prefetch(q, row, plane, later);
            source.prefetch(later.marker);
            const double *f = source.value + 3 * m.marker, strength = source.factor * source.volume[m.marker];
            if (m.is_wrapped()) {
                spread_wrapped(g, q, m, weights, n, f, strength, first, last);
                continue;
            }
            spread_inner<0, bounded>(row, plane, q.u, m, weights, n, strength * f[0], k - 1, first, last);
            spread_inner<1, bounded>(row, plane, q.v, m, weights, n, strength * f[1], k - 1, first, last);
            spread_inner<2, bounded>(row, plane, q.w, m, weights, n, strength * f[2], k - 1, first, last);
        }
    }
}

// q += factor * sum over markers of value * volume * delta: the adjoint of interpolate.
inline void spread(const Grid& g, const VelocityArrays& q, const StencilSet& set, const double* value,
                   const double* volume, double factor) {
    double* field[3] = {q.u, q.v, q.w};
    const Source source{value, volume, factor / g.volume()};
    const int nz = g.nz();
    const long inner = set.count_inner();
    const int threads = set.count() > 256 ? std::min(g.threads, nz) : 1;
#pragma omp parallel num_threads(threads)
    {
        const int team = omp_get_num_threads(), me = omp_get_thread_num();
        // Equal numbers of markers, cut between planes.
        const auto cut = [&](int t) {
            if (t == team) return nz + 1;
            int k = 1;
            while (k <= nz && set.begin_of(g, k) < inner * t / team) ++k;
            return t == 0 ? 1 : k;
        };
        const int first = cut(me), last = cut(me + 1);
        // Plane k gives to planes k - 2 to k + 1, beyond a periodic side to those at the other.
        const auto reaches = [&](int k) {
            for (int at = k - 2; at <= k + 1; ++at) {
                const int wrapped = at < 1 ? at + nz : at > nz ? at - nz : at;
                if (wrapped >= first && wrapped < last) return true;
            }
            return false;
        };
        for (int k = 1; k <= nz; ++k) {
            if (!reaches(k)) continue;
            if (k - 2 >= first && k + 1 < last)
                spread_from_plane<false>(g, q, set, source, k, first, last);
            else
                spread_from_plane<true>(g, q, set, source, k, first, last);
        }
        for (const FoldedStencils& s : set.folded) {
            const double strength = source.factor * volume[s.marker];
            for (int c = 0; c < 3; ++c)
                spread_folded(g, field[c], s, c, strength * value[3 * s.marker + c], first, last);
        }
    }
}

}  // namespace rdpm
