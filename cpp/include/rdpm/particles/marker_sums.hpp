// What is done with the values at a body's markers: turned with it, summed, made those of a rigid motion.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cstdint>

namespace rdpm {

// Turns body axes into box axes by a unit quaternion (w, x, y, z).
struct Turn {
    double row[3][3];

    explicit Turn(const double* o) {
        const double w = o[0], x = o[1], y = o[2], z = o[3];
        const double turn[3][3] = {
            {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
            {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
            {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}};
        std::copy_n(&turn[0][0], 9, &row[0][0]);
    }
    double forth(const double* v, int c) const {
        return row[c][0] * v[0] + row[c][1] * v[1] + row[c][2] * v[2];
    }
    double back(const double* v, int c) const {
        return row[0][c] * v[0] + row[1][c] * v[1] + row[2][c] * v[2];
    }
};

// Arms, positions and forces of each body's markers from arms and forces in its axes.
inline void move_markers(int bodies, const std::int32_t* first, const double* orientation,
                         const double* centre, const double* body_arm, const double* body_force, int threads,
                         double* arm, double* position, double* force) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        const Turn turn(orientation + 4 * b);
        for (int m = first[b]; m < first[b + 1]; ++m)
            for (int c = 0; c < 3; ++c) {
                arm[3 * m + c] = turn.forth(body_arm + 3 * m, c);
                position[3 * m + c] = arm[3 * m + c] + centre[3 * b + c];
                force[3 * m + c] = turn.forth(body_force + 3 * m, c);
            }
    }
}

// Lagged forces: the share of each marker's force that the next step starts from, in its body's axes; `force`
// is reduced to it as well.
inline void store_forces(int bodies, const std::int32_t* first, const double* orientation, double share,
                         int threads, double* force, double* body_force) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        const Turn turn(orientation + 4 * b);
        for (int m = first[b]; m < first[b + 1]; ++m) {
            double* f = force + 3 * m;
            for (int c = 0; c < 3; ++c) f[c] *= share;
            for (int c = 0; c < 3; ++c) body_force[3 * m + c] = turn.back(f, c);
        }
    }
}

// Sum of volume * value, and of arm x (volume * value).
struct Impulse {
    double sum[6] = {};

    void add(const double* arm, double volume, const double* value) {
        const double fx = volume * value[0], fy = volume * value[1], fz = volume * value[2];
        sum[0] += fx;
        sum[1] += fy;
        sum[2] += fz;
        sum[3] += arm[1] * fz - arm[2] * fy;
        sum[4] += arm[2] * fx - arm[0] * fz;
        sum[5] += arm[0] * fy - arm[1] * fx;
    }
};

// The impulse of the values at each body's markers, in their order. (bodies, 6).
inline void sum_over_markers(int bodies, const std::int32_t* first, const double* arm, const double* volume,
                             const double* value, int threads, double* out) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        Impulse impulse;
        for (int m = first[b]; m < first[b + 1]; ++m) impulse.add(arm + 3 * m, volume[m], value + 3 * m);
        std::copy_n(impulse.sum, 6, out + 6 * b);
    }
}

// The velocity of the fluid at the markers becomes its change to the body's rigid motion; force += change /
// dt. Of each body, (bodies, 7): the impulse of the change, and the sum of its square.
inline void rigid_change(int bodies, const std::int32_t* first, const double* arm, const double* volume,
                         const double* velocity, const double* angular_velocity, double inverse_dt,
                         int threads, double* change, double* force, double* out) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        const double *v = velocity + 3 * b, *o = angular_velocity + 3 * b;
        Impulse impulse;
        double squares = 0.0;
        for (int m = first[b]; m < first[b + 1]; ++m) {
            const double *r = arm + 3 * m, *u = change + 3 * m;
            const double gained[3] = {v[0] + o[1] * r[2] - o[2] * r[1] - u[0],
                                      v[1] + o[2] * r[0] - o[0] * r[2] - u[1],
                                      v[2] + o[0] * r[1] - o[1] * r[0] - u[2]};
            impulse.add(r, volume[m], gained);
            squares += gained[0] * gained[0] + gained[1] * gained[1] + gained[2] * gained[2];
            for (int c = 0; c < 3; ++c) {
                change[3 * m + c] = gained[c];
                force[3 * m + c] += inverse_dt * gained[c];
            }
        }
        std::copy_n(impulse.sum, 6, out + 7 * b);
        out[7 * b + 6] = squares;
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
