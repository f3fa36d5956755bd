// The same arithmetic as the kernels, as a plain compiled loop: the yardstick of the benchmark, not part of any simulation.
//
// One velocity field, one window. The number of dimensions D and of table entries E are compile-time constants and arrays do
// not overlap, both of which the kernels do not know. Every exported function takes one pointer to the arrays of the problem:
// stage by stage with an interpolation table, as the kernels work, and a whole step that keeps none and fills a point's rows twice.

#include <cmath>
#include <cstdint>

namespace {

struct Problem {
    int64_t n_particles, n_nodes, nodes_per_axis;
    double h, dt, flip, bulk, shear;
    // material points
    double *position, *velocity, *mass, *initial_volume, *volume;
    double *deformation, *velocity_gradient, *stress, *affine, *half_edges, *half_length;
    // interpolation table
    int32_t* nodes;
    double *weight, *gradient;
    // grid
    double *node_position, *node_mass, *momentum, *start_velocity, *force, *node_velocity;
};

constexpr int power(int base, int exponent) { return exponent == 0 ? 1 : base * power(base, exponent - 1); }

template <int D>
inline double determinant(const double a[D][D]) {
    if constexpr (D == 2) {
        return a[0][0] * a[1][1] - a[0][1] * a[1][0];
    } else {
        return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
               a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    }
}

template <int D>
inline void invert(const double a[D][D], double out[D][D]) {
    const double scale = 1.0 / determinant<D>(a);
    if constexpr (D == 2) {
        out[0][0] = a[1][1] * scale;
        out[0][1] = -a[0][1] * scale;
        out[1][0] = -a[1][0] * scale;
        out[1][1] = a[0][0] * scale;
    } else {
        for (int i = 0; i < 3; i++)
            for (int m = 0; m < 3; m++) {
                const int j = (i + 1) % 3, k = (i + 2) % 3, n = (m + 1) % 3, o = (m + 2) % 3;
                out[m][i] = (a[j][n] * a[k][o] - a[j][o] * a[k][n]) * scale;
            }
    }
}

template <int D, int W>
inline void tensor_product(const double base[D], const double w[D][W], const double s[D][W], int64_t extent,
                           int32_t* __restrict nodes, double* __restrict weight, double* __restrict gradient) {
    int64_t node = 0;
    for (int d = 0; d < D; d++) node = node * extent + static_cast<int64_t>(base[d]);
    int k = 0;
    for (int a = 0; a < W; a++)
        for (int b = 0; b < W; b++) {
            if constexpr (D == 2) {
                nodes[k] = static_cast<int32_t>(node + a * extent + b);
                weight[k] = w[0][a] * w[1][b];
                gradient[2 * k] = s[0][a] * w[1][b];
                gradient[2 * k + 1] = w[0][a] * s[1][b];
                k++;
            } else {
                for (int c = 0; c < W; c++) {
                    nodes[k] = static_cast<int32_t>(node + (a * extent + b) * extent + c);
                    weight[k] = w[0][a] * w[1][b] * w[2][c];
                    gradient[3 * k] = s[0][a] * w[1][b] * w[2][c];
                    gradient[3 * k + 1] = w[0][a] * s[1][b] * w[2][c];
                    gradient[3 * k + 2] = w[0][a] * w[1][b] * s[2][c];
                    k++;
                }
            }
        }
}

struct Linear {
    static constexpr int width = 2;
    static double weights(double xi, double, double inverse_h, double w[2], double s[2]) {
        const double base = std::floor(xi), t = xi - base;
        w[0] = 1.0 - t;
        w[1] = t;
        s[0] = -inverse_h;
        s[1] = inverse_h;
        return base;
    }
};

struct BSpline {
    static constexpr int width = 3;
    static double weights(double xi, double, double inverse_h, double w[3], double s[3]) {
        const double base = std::floor(xi - 0.5), t = xi - base;
        w[0] = 0.5 * (1.5 - t) * (1.5 - t);
        w[1] = 0.75 - (t - 1.0) * (t - 1.0);
        w[2] = 0.5 * (t - 0.5) * (t - 0.5);
        s[0] = (t - 1.5) * inverse_h;
        s[1] = -2.0 * (t - 1.0) * inverse_h;
        s[2] = (t - 0.5) * inverse_h;
        return base;
    }
};

struct Gimp {
    static constexpr int width = 3;
    static double weights(double xi, double l, double inverse_h, double w[3], double s[3]) {
        const double base = std::floor(xi - l), u = xi - l - base;
        const double b = std::fmax(u + 2.0 * l - 1.0, 0.0), a = 2.0 * l - b;
        const double share = 0.5 / l, rise = a * (u + 0.5 * a);
        w[0] = (a - rise) * share;
        w[1] = (rise + b - 0.5 * b * b) * share;
        w[2] = 0.5 * b * b * share;
        s[0] = -a * share * inverse_h;
        s[1] = (a - b) * share * inverse_h;
        s[2] = b * share * inverse_h;
        return base;
    }
};

// Rows of one point: E nodes, weights, and gradients of D components.
template <class Shape, int D>
struct Tensor {
    static constexpr int dim = D, entries = power(Shape::width, D);
    static void fill(const Problem& x, int64_t p, int32_t* nodes, double* weight, double* gradient) {
        constexpr int W = Shape::width;
        const double inverse_h = 1.0 / x.h;
        double base[D], w[D][W], s[D][W];
        for (int d = 0; d < D; d++)
            base[d] = Shape::weights(x.position[p * D + d] * inverse_h, x.half_length[p] * inverse_h, inverse_h, w[d], s[d]);
        tensor_product<D, W>(base, w, s, x.nodes_per_axis, nodes, weight, gradient);
    }
};

template <int D>
struct Cpdi {
    static constexpr int dim = D, entries = power(4, D);
    static void fill(const Problem& x, int64_t p, int32_t* nodes, double* weight, double* gradient) {
        constexpr int C = power(2, D);
        const double inverse_h = 1.0 / x.h, share = 1.0 / C;
        double r[D][D], inverse[D][D];
        for (int d = 0; d < D; d++)
            for (int e = 0; e < D; e++) {
                r[d][e] = 0.0;
                for (int a = 0; a < D; a++)
                    r[d][e] += x.deformation[(p * D + d) * D + a] * x.half_edges[(p * D + a) * D + e];
            }
        invert<D>(r, inverse);
        for (int c = 0; c < C; c++) {
            double fraction[D], slope[D];
            int64_t node = 0;
            for (int d = 0; d < D; d++) {
                double corner = x.position[p * D + d];
                slope[d] = 0.0;
                for (int e = 0; e < D; e++) {
                    const double sign = (c >> e) & 1 ? 1.0 : -1.0;
                    corner += sign * r[d][e];
                    slope[d] += sign * share * inverse[e][d];
                }
                const double xi = corner * inverse_h, cell = std::floor(xi);
                fraction[d] = xi - cell;
                node = node * x.nodes_per_axis + static_cast<int64_t>(cell);
            }
            for (int entry = 0; entry < C; entry++) {
                int64_t index = 0;
                double n = 1.0;
                for (int d = 0; d < D; d++) {
                    const int bit = (entry >> (D - 1 - d)) & 1;
                    index = index * x.nodes_per_axis + bit;
                    n *= bit ? fraction[d] : 1.0 - fraction[d];
                }
                const int k = c * C + entry;
                nodes[k] = static_cast<int32_t>(node + index);
                weight[k] = share * n;
                for (int d = 0; d < D; d++) gradient[k * D + d] = slope[d] * n;
            }
        }
    }
};

template <int D, int E>
inline void project(Problem& x, int64_t p, const int32_t* nodes, const double* weight) {
    double *__restrict node_mass = x.node_mass, *__restrict momentum = x.momentum;
    double v[D], c[D][D];
    for (int d = 0; d < D; d++) {
        v[d] = x.velocity[p * D + d];
        for (int e = 0; e < D; e++) {
            c[d][e] = x.affine[(p * D + d) * D + e];
            v[d] -= c[d][e] * x.position[p * D + e];
        }
    }
    const double m = x.mass[p];
    for (int k = 0; k < E; k++) {
        const int64_t i = nodes[k];
        const double phi_m = weight[k] * m;
        node_mass[i] += phi_m;
        for (int d = 0; d < D; d++) {
            double v_i = v[d];
            for (int e = 0; e < D; e++) v_i += c[d][e] * x.node_position[i * D + e];
            momentum[i * D + d] += phi_m * v_i;
        }
    }
}

template <int D, int E>
inline void internal_force(Problem& x, int64_t p, const int32_t* nodes, const double* gradient) {
    double* __restrict force = x.force;
    double s[D][D];
    for (int d = 0; d < D; d++)
        for (int e = 0; e < D; e++) s[d][e] = -x.volume[p] * x.stress[(p * D + d) * D + e];
    for (int k = 0; k < E; k++) {
        const int64_t i = nodes[k];
        for (int d = 0; d < D; d++) {
            double f = 0.0;
            for (int e = 0; e < D; e++) f += s[d][e] * gradient[k * D + e];
            force[i * D + d] += f;
        }
    }
}

// Calls f(0) ... f(D - 1), written out: GCC keeps arrays indexed in a loop in memory and those indexed by constants in registers.
template <int D, class F>
inline void axes(F f) {
    f(0);
    f(1);
    if constexpr (D == 3) f(2);
}

// Affine field B D^-1, or the velocity gradient itself where D can be singular (linear shape functions).
template <int D, int E, bool LeastSquares>
inline void gather(Problem& x, int64_t p, const int32_t* nodes, const double* weight, const double* gradient) {
    const double *__restrict node_position = x.node_position, *__restrict node_velocity = x.node_velocity,
                 *__restrict start_velocity = x.start_velocity;
    double xp[D], v[D] = {}, increment[D] = {}, l[D][D] = {}, moment[D][D] = {}, spread[D][D] = {}, inverse[D][D];
    axes<D>([&](int d) { xp[d] = x.position[p * D + d]; });
    for (int k = 0; k < E; k++) {
        const int64_t i = nodes[k];
        const double phi = weight[k];
        double q[D];
        axes<D>([&](int d) { q[d] = node_position[i * D + d] - xp[d]; });
        axes<D>([&](int d) {
            const double v_i = node_velocity[i * D + d], phi_v = phi * v_i, phi_q = phi * q[d];
            v[d] += phi_v;
            increment[d] += phi * (v_i - start_velocity[i * D + d]);
            axes<D>([&](int e) {
                l[d][e] += v_i * gradient[k * D + e];
                if constexpr (LeastSquares) {
                    moment[d][e] += phi_v * q[e];
                    if (e >= d) spread[d][e] += phi_q * q[e];
                }
            });
        });
    }
    axes<D>([&](int d) {
        axes<D>([&](int e) {
            if (e < d) spread[d][e] = spread[e][d];
        });
    });
    if constexpr (LeastSquares) invert<D>(spread, inverse);
    axes<D>([&](int d) {
        x.velocity[p * D + d] = x.flip * (x.velocity[p * D + d] + increment[d]) + (1.0 - x.flip) * v[d];
        x.position[p * D + d] = xp[d] + x.dt * v[d];
        axes<D>([&](int e) {
            double c = l[d][e];
            if constexpr (LeastSquares) {
                c = 0.0;
                axes<D>([&](int a) { c += moment[d][a] * inverse[a][e]; });
            }
            x.affine[(p * D + d) * D + e] = c;
            x.velocity_gradient[(p * D + d) * D + e] = l[d][e];
        });
    });
}

template <int D>
inline void transport_affine(Problem& x, int64_t p) {
    double c[D][D], motion[D][D], inverse[D][D];
    for (int d = 0; d < D; d++)
        for (int e = 0; e < D; e++) {
            c[d][e] = x.affine[(p * D + d) * D + e];
            motion[d][e] = x.dt * c[d][e] + (d == e ? 1.0 : 0.0);
        }
    invert<D>(motion, inverse);
    for (int d = 0; d < D; d++)
        for (int e = 0; e < D; e++) {
            double value = 0.0;
            for (int a = 0; a < D; a++) value += c[d][a] * inverse[a][e];
            x.affine[(p * D + d) * D + e] = value;
        }
}

template <int D>
inline void update_deformation(Problem& x, int64_t p) {
    double f[D][D], out[D][D];
    for (int d = 0; d < D; d++)
        for (int e = 0; e < D; e++) f[d][e] = x.deformation[(p * D + d) * D + e];
    for (int d = 0; d < D; d++)
        for (int e = 0; e < D; e++) {
            double value = f[d][e];
            for (int a = 0; a < D; a++) value += x.dt * x.velocity_gradient[(p * D + d) * D + a] * f[a][e];
            out[d][e] = value;
        }
    for (int d = 0; d < D; d++)
        for (int e = 0; e < D; e++) x.deformation[(p * D + d) * D + e] = out[d][e];
    x.volume[p] = determinant<D>(out) * x.initial_volume[p];
}

// Compressible neo-Hookean solid, sigma = [G (b - 1) + lambda ln J 1] / J with b = F F^T.
template <int D>
inline void update_stress(Problem& x, int64_t p) {
    const double lambda = x.bulk - 2.0 / 3.0 * x.shear;
    double f[D][D];
    for (int d = 0; d < D; d++)
        for (int e = 0; e < D; e++) f[d][e] = x.deformation[(p * D + d) * D + e];
    const double j = determinant<D>(f), pressure = lambda * std::log(j) - x.shear;
    for (int d = 0; d < D; d++)
        for (int e = 0; e < D; e++) {
            double b = 0.0;
            for (int a = 0; a < D; a++) b += f[d][a] * f[e][a];
            x.stress[(p * D + d) * D + e] = (x.shear * b + (d == e ? pressure : 0.0)) / j;
        }
}

template <int D>
void reset_nodes(Problem& x) {
    for (int64_t i = 0; i < x.n_nodes; i++) {
        x.node_mass[i] = 0.0;
        for (int d = 0; d < D; d++) x.momentum[i * D + d] = x.force[i * D + d] = 0.0;
    }
}

template <int D>
void start_velocity(Problem& x) {
    for (int64_t i = 0; i < x.n_nodes; i++) {
        const double inverse = x.node_mass[i] > 0.0 ? 1.0 / x.node_mass[i] : 0.0;
        for (int d = 0; d < D; d++) x.start_velocity[i * D + d] = x.momentum[i * D + d] * inverse;
    }
}

template <int D>
void integrate_nodes(Problem& x) {
    for (int64_t i = 0; i < x.n_nodes; i++) {
        const double inverse = x.node_mass[i] > 0.0 ? 1.0 / x.node_mass[i] : 0.0;
        for (int d = 0; d < D; d++) {
            if (x.node_mass[i] > 0.0) x.momentum[i * D + d] += x.dt * x.force[i * D + d];
            x.node_velocity[i * D + d] = x.momentum[i * D + d] * inverse;
        }
    }
}

template <class Shape>
struct Step {
    static constexpr int D = Shape::dim, E = Shape::entries;

    static void fill(Problem& x) {
        for (int64_t p = 0; p < x.n_particles; p++) Shape::fill(x, p, x.nodes + p * E, x.weight + p * E, x.gradient + p * E * D);
    }
    static void to_nodes(Problem& x) {
        reset_nodes<D>(x);
        for (int64_t p = 0; p < x.n_particles; p++) project<D, E>(x, p, x.nodes + p * E, x.weight + p * E);
        start_velocity<D>(x);
    }
    static void force(Problem& x) {
        for (int64_t p = 0; p < x.n_particles; p++) internal_force<D, E>(x, p, x.nodes + p * E, x.gradient + p * E * D);
        integrate_nodes<D>(x);
    }
    static void to_points(Problem& x) {
        for (int64_t p = 0; p < x.n_particles; p++) {
            gather<D, E, (E > power(2, D))>(x, p, x.nodes + p * E, x.weight + p * E, x.gradient + p * E * D);
            transport_affine<D>(x, p);
        }
    }
    static void material(Problem& x) {
        for (int64_t p = 0; p < x.n_particles; p++) {
            update_deformation<D>(x, p);
            update_stress<D>(x, p);
        }
    }
    // The same without a table.
    static void whole(Problem& x) {
        int32_t nodes[E];
        double weight[E], gradient[E * D];
        reset_nodes<D>(x);
        for (int64_t p = 0; p < x.n_particles; p++) {
            Shape::fill(x, p, nodes, weight, gradient);
            project<D, E>(x, p, nodes, weight);
            internal_force<D, E>(x, p, nodes, gradient);
        }
        start_velocity<D>(x);
        integrate_nodes<D>(x);
        for (int64_t p = 0; p < x.n_particles; p++) {
            Shape::fill(x, p, nodes, weight, gradient);
            gather<D, E, (E > power(2, D))>(x, p, nodes, weight, gradient);
            transport_affine<D>(x, p);
            update_deformation<D>(x, p);
            update_stress<D>(x, p);
        }
    }
};

}  // namespace

#define STAGES_OF(shape, D, ...)                                                         \
    extern "C" void shape##_##D##_shape(Problem* x) { Step<__VA_ARGS__>::fill(*x); }          \
    extern "C" void shape##_##D##_projection(Problem* x) { Step<__VA_ARGS__>::to_nodes(*x); } \
    extern "C" void shape##_##D##_force(Problem* x) { Step<__VA_ARGS__>::force(*x); }         \
    extern "C" void shape##_##D##_gather(Problem* x) { Step<__VA_ARGS__>::to_points(*x); }    \
    extern "C" void shape##_##D##_material(Problem* x) { Step<__VA_ARGS__>::material(*x); }   \
    extern "C" void shape##_##D##_step(Problem* x) { Step<__VA_ARGS__>::whole(*x); }

STAGES_OF(linear, 2, Tensor<Linear, 2>)
STAGES_OF(linear, 3, Tensor<Linear, 3>)
STAGES_OF(gimp, 2, Tensor<Gimp, 2>)
STAGES_OF(gimp, 3, Tensor<Gimp, 3>)
STAGES_OF(bspline, 2, Tensor<BSpline, 2>)
STAGES_OF(bspline, 3, Tensor<BSpline, 3>)
STAGES_OF(cpdi, 2, Cpdi<2>)
STAGES_OF(cpdi, 3, Cpdi<3>)
