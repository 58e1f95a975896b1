// What is done with the values at a body's markers: turned with it, summed, made those of a rigid motion.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cstdint>

namespace rdpm {

// Vectors of each body's markers turned by its unit quaternion (w, x, y, z), or back; `centre` is added if
// given.
inline void turn_vectors(int bodies, const std::int32_t* first, const double* orientation,
                         const double* centre, const double* in, bool back, int threads, double* out) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        const double *o = orientation + 4 * b, w = o[0], x = back ? -o[1] : o[1], y = back ? -o[2] : o[2],
                     z = back ? -o[3] : o[3];
        const double turn[3][3] = {
            {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
            {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
            {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}};
        for (int m = first[b]; m < first[b + 1]; ++m) {
            const double v[3] = {in[3 * m], in[3 * m + 1], in[3 * m + 2]};
            for (int c = 0; c < 3; ++c)
                out[3 * m + c] = turn[c][0] * v[0] + turn[c][1] * v[1] + turn[c][2] * v[2] +
                                 (centre ? centre[3 * b + c] : 0.0);
        }
    }
}

// Of each body: sum of volume * value, sum of arm x (volume * value), in the order of its markers. (bodies,
// 6).
inline void sum_over_markers(int bodies, const std::int32_t* first, const double* arm, const double* volume,
                             const double* value, int threads, double* out) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        double s[6] = {};
        for (int m = first[b]; m < first[b + 1]; ++m) {
            const double *r = arm + 3 * m, fx = volume[m] * value[3 * m], fy = volume[m] * value[3 * m + 1],
                         fz = volume[m] * value[3 * m + 2];
            s[0] += fx;
            s[1] += fy;
            s[2] += fz;
            s[3] += r[1] * fz - r[2] * fy;
            s[4] += r[2] * fx - r[0] * fz;
            s[5] += r[0] * fy - r[1] * fx;
        }
        std::copy_n(s, 6, out + 6 * b);
    }
}

// change = rigid velocity of the body - velocity of the fluid there; force += change / dt.
inline void rigid_change(int bodies, const std::int32_t* first, const double* arm, const double* velocity,
                         const double* spin, const double* fluid, double inverse_dt, int threads,
                         double* change, double* force) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        const double *v = velocity + 3 * b, *o = spin + 3 * b;
        for (int m = first[b]; m < first[b + 1]; ++m) {
            const double* r = arm + 3 * m;
            const double rigid[3] = {v[0] + o[1] * r[2] - o[2] * r[1], v[1] + o[2] * r[0] - o[0] * r[2],
                                     v[2] + o[0] * r[1] - o[1] * r[0]};
            for (int c = 0; c < 3; ++c) {
                change[3 * m + c] = rigid[c] - fluid[3 * m + c];
                force[3 * m + c] += inverse_dt * change[3 * m + c];
            }
        }
    }
}

// Of each body, its markers' volume V and moments about the centre: V, sum of V r (3), sum of V r r
// (xx, yy, zz, xy, yz, zx). (bodies, 10).
inline void marker_moments(int bodies, const std::int32_t* first, const double* arm, const double* volume,
                           int threads, double* out) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        double s[10] = {};
        for (int m = first[b]; m < first[b + 1]; ++m) {
            const double *r = arm + 3 * m, v = volume[m];
            s[0] += v;
            for (int c = 0; c < 3; ++c) {
                s[1 + c] += v * r[c];
                s[4 + c] += v * r[c] * r[c];
                s[7 + c] += v * r[c] * r[(c + 1) % 3];
            }
        }
        std::copy_n(s, 10, out + 10 * b);
    }
}

}  // namespace rdpm
