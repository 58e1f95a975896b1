// The staggered grid: sizes, spacings, boundaries; and the halo of one plane.
//
// Arrays are [k][j][i] with one halo cell on each side: (nz+2, ny+2, nx+2). Cell (k, j, i) has indices 1..n.
// u[k][j][i] sits on the face between cells i and i+1, v between j and j+1, w between k and k+1.
#pragma once
#include <array>
#include <cstddef>

namespace rdpm {

// Of a pair of opposite faces. The last two let the fluid through: in at the lower face and out at the upper
// one, or the other way round. Normal velocities there are set from outside, before a projection.
enum Boundary : int { periodic = 0, wall = 1, free_slip = 2, inflow_lower = 3, inflow_upper = 4 };

// Where a field sits: at cell centres, or on the faces across one direction.
enum Location : int { face_x = 0, face_y = 1, face_z = 2, centre = 3 };

// Of a direction: sums and doubles of indices stay within 32 bits.
constexpr int most_cells = 1 << 29;

struct Grid {
    std::array<int, 3> cells{};              // nx, ny, nz
    std::array<double, 3> spacing{};         // dx, dy, dz [m]
    std::array<int, 3> boundary{};           // of the x, y, z pairs
    std::array<double, 18> wall_velocity{};  // [face][component] [m/s]; x_lower, x_upper, y_lower, ...
    int threads = 1;
    // A slab of a box cut across z: planes of the box below it, planes of the whole box (0: it is the box),
    // and whether its lower and upper end adjoin another slab, from which their halo comes.
    int planes_below = 0, box_planes = 0;
    std::array<bool, 2> joined{};

    int nx() const { return cells[0]; }
    int ny() const { return cells[1]; }
    int nz() const { return cells[2]; }
    std::size_t row() const { return static_cast<std::size_t>(cells[0]) + 2; }
    std::size_t plane() const { return row() * (static_cast<std::size_t>(cells[1]) + 2); }
    // With its halo.
    std::size_t field_size() const { return plane() * (static_cast<std::size_t>(cells[2]) + 2); }
    double volume() const { return spacing[0] * spacing[1] * spacing[2]; }
    double velocity_of_face(int face, int component) const { return wall_velocity[3 * face + component]; }

    // Whether fluid passes through the pair of faces, and whether it leaves through this one.
    bool is_open(int direction) const { return boundary[direction] >= inflow_lower; }
    bool is_outflow(int face) const {
        return boundary[face / 2] == (face % 2 == 1 ? inflow_lower : inflow_upper);
    }

    // The same cells and boundaries: what was made for one serves the other.
    bool is_like(const Grid& other) const {
        return cells == other.cells && spacing == other.spacing && boundary == other.boundary &&
               planes_below == other.planes_below && box_planes == other.box_planes && joined == other.joined;
    }

    bool is_slab() const { return box_planes > 0; }
    // Of the box, of which this may be a slab.
    int whole(int direction) const { return direction == 2 && is_slab() ? box_planes : cells[direction]; }
    // Index of a plane of the box, 1 to `whole(2)`, among those of the slab.
    int plane_here(int plane) const { return plane - planes_below; }
    // Whether the first plane follows the last one here: the planes of a slab end at other slabs.
    bool wraps(int direction) const {
        return boundary[direction] == periodic && !(direction == 2 && is_slab());
    }
    bool has_face(int direction, int side) const {
        return boundary[direction] != periodic && !(direction == 2 && joined[side]);
    }

    // Planes whose normal face is inside the box: the last face of a walled direction is the wall itself.
    int last_face(int direction) const { return cells[direction] - (has_face(direction, 1) ? 1 : 0); }
};

// The planes [first, last) of 1..n that thread `t` of `threads` owns.
inline std::array<int, 2> share_of(int n, int t, int threads) {
    return {1 + static_cast<int>(static_cast<long>(n) * t / threads),
            1 + static_cast<int>(static_cast<long>(n) * (t + 1) / threads)};
}

// A halo value beyond a face is `sign * inner + offset`: -1 and twice the wall's speed at a no-slip wall, +1
// at free slip. Fluid enters along the normal, as at a wall at rest, and leaves without a gradient across it.
struct Mirror {
    double sign, offset;
};

inline Mirror mirror(const Grid& g, int face, int component) {
    if (component == centre || g.boundary[face / 2] == free_slip || g.is_outflow(face)) return {1.0, 0.0};
    return {-1.0, 2.0 * g.velocity_of_face(face, component)};
}

// Of a velocity, walls move at their speed; to a change of it they add nothing.
enum class Walls { moving, at_rest };

// Halo cells of one plane in x and y. What passes through open faces stays; a change of it is zero.
inline void fill_plane_halo(const Grid& g, double* q, int location, Walls walls) {
    const int nx = g.nx(), ny = g.ny();
    const std::size_t row = g.row();
    const bool passes_x = location == face_x && g.is_open(0) && walls == Walls::moving,
               passes_y = location == face_y && g.is_open(1) && walls == Walls::moving;
    const int first_row = passes_y ? 0 : 1;  // of its faces, the lowest is then no halo
    const auto halo_of = [&](int s) {
        Mirror m = mirror(g, s, location);
        if (walls == Walls::at_rest) m.offset = 0.0;
        return m;
    };
    if (g.boundary[0] == periodic) {
        for (int j = first_row; j <= ny; ++j) {
            double* r = q + j * row;
            r[0] = r[nx];
            r[nx + 1] = r[1];
        }
    } else if (passes_x) {
        for (int j = 1; j <= ny; ++j) q[j * row + nx + 1] = q[j * row + nx];
    } else if (location == face_x) {
        for (int j = 1; j <= ny; ++j) {
            double* r = q + j * row;
            r[0] = r[nx] = 0.0;
            r[nx + 1] = -r[nx - 1];
        }
    } else {
        const Mirror lower = halo_of(0), upper = halo_of(1);
        for (int j = first_row; j <= ny; ++j) {
            double* r = q + j * row;
            r[0] = lower.sign * r[1] + lower.offset;
            r[nx + 1] = upper.sign * r[nx] + upper.offset;
        }
    }
    double *first = q, *last = q + (ny + 1) * row;
    const double *inner_first = q + row, *inner_last = q + ny * row;
    if (g.boundary[1] == periodic) {
        for (int i = 0; i < nx + 2; ++i) {
            first[i] = inner_last[i];
            last[i] = inner_first[i];
        }
    } else if (passes_y) {
        for (int i = 0; i < nx + 2; ++i) last[i] = inner_last[i];
    } else if (location == face_y) {
        double *at_wall = q + ny * row, *below = q + (ny - 1) * row;
        for (int i = 0; i < nx + 2; ++i) {
            first[i] = at_wall[i] = 0.0;
            last[i] = -below[i];
        }
    } else {
        const Mirror lower = halo_of(2), upper = halo_of(3);
        for (int i = 0; i < nx + 2; ++i) {
            first[i] = lower.sign * inner_first[i] + lower.offset;
            last[i] = upper.sign * inner_last[i] + upper.offset;
        }
    }
}

// The two halo planes in z, from planes whose own halos are current; not those that come from another slab.
inline void fill_end_planes(const Grid& g, double* q, int location) {
    const std::size_t plane = g.plane();
    const int nz = g.nz();
    double *bottom = q, *top = q + (nz + 1) * plane;
    if (g.wraps(2)) {
        for (std::size_t i = 0; i < plane; ++i) {
            bottom[i] = q[nz * plane + i];
            top[i] = q[plane + i];
        }
        return;
    }
    const bool on_faces = location == face_z;
    if (g.has_face(2, 0) && !(on_faces && g.is_open(2))) {
        const Mirror lower = mirror(g, 4, location);
        for (std::size_t i = 0; i < plane; ++i)
            bottom[i] = on_faces ? 0.0 : lower.sign * q[plane + i] + lower.offset;
    }
    if (g.has_face(2, 1)) {
        if (on_faces && g.is_open(2)) {
            for (std::size_t i = 0; i < plane; ++i) top[i] = q[nz * plane + i];
        } else if (on_faces) {
            for (std::size_t i = 0; i < plane; ++i) {
                q[nz * plane + i] = 0.0;
                top[i] = -q[(nz - 1) * plane + i];
            }
        } else {
            const Mirror upper = mirror(g, 5, location);
            for (std::size_t i = 0; i < plane; ++i) top[i] = upper.sign * q[nz * plane + i] + upper.offset;
        }
    }
}

inline void fill_halo(const Grid& g, double* q, int location) {
#pragma omp parallel for num_threads(g.threads) schedule(static)
    for (int k = location == face_z && g.is_open(2) ? 0 : 1; k <= g.nz(); ++k)
        fill_plane_halo(g, q + k * g.plane(), location, Walls::moving);
    fill_end_planes(g, q, location);
}

}  // namespace rdpm
