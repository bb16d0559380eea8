#include "dem/dynamic_bonds.h"

#include "dem/phi_functions.h"
#include "dem/transpose8.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace dem {

namespace {

constexpr int lanes = 8;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Fields of a block in the order of the docstring.
enum Field { normal = 0, distance = 3, tangent = 4, modes = 7 };
enum Constant { k_normal, k_shear, k_torsion, k_bending, offset, s_normal, s_shear };

constexpr int constant(int n_modes, Constant which)
{
  return modes + 6 * n_modes + which;
}

double* field(DynamicBonds& bonds, Index block, int which)
{
  return bonds.fields.data() + (std::size_t(block) * n_fields(bonds.n_modes) + which) * lanes;
}

const double* field(const DynamicBonds& bonds, Index block, int which)
{
  return bonds.fields.data() + (std::size_t(block) * n_fields(bonds.n_modes) + which) * lanes;
}

/// Bonds in the order of their lower slot, then law: near bonds lie together.
std::vector<Index> sorted_bonds(const Assembly& assembly, std::span<const Index> slot)
{
  std::vector<Index> order(assembly.bonds.size());
  std::iota(order.begin(), order.end(), 0);
  const auto lower = [&](Index b) {
    const auto [i, j] = assembly.bonds.ends[b];
    return std::min(slot[i], slot[j]);
  };
  std::ranges::stable_sort(order, {}, lower);
  return order;
}

void fill_lane(DynamicBonds& bonds, const Assembly& assembly, Index lane, Index b)
{
  const Index block = lane / lanes, l = lane % lanes;
  const auto [i, j] = assembly.bonds.ends[b];
  const Vec3 branch = assembly.particles.centre[j] - assembly.particles.centre[i];
  const Vec3 n = branch / branch.norm();
  int smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  const Vec3 t = n.cross(Vec3::Unit(smallest)).normalized();
  for (int k = 0; k < 3; ++k) {
    field(bonds, block, normal + k)[l] = n[k];
    field(bonds, block, tangent + k)[l] = t[k];
  }
  field(bonds, block, distance)[l] = branch.norm();
  const BondLaw& law = assembly.laws[assembly.bonds.law[b]];
  set_stiffness(bonds, lane, mode_stiffness(law, assembly.bonds.section_radius[b]));
  const auto set = [&](Constant which, double value) {
    field(bonds, block, constant(bonds.n_modes, which))[l] = value;
  };
  set(offset, assembly.bonds.contact_offset[b]);
  set(s_normal, assembly.strengths ? assembly.strengths->normal[b] : infinity);
  set(s_shear, assembly.strengths ? assembly.strengths->shear[b] : infinity);
}

/// A lane without a bond repeats the geometry of the lane before it, without stiffness.
void fill_idle_lane(DynamicBonds& bonds, Index lane)
{
  const Index block = lane / lanes, l = lane % lanes;
  bonds.ends[block * 2 * lanes + l] = bonds.ends[block * 2 * lanes + l - 1];
  bonds.ends[block * 2 * lanes + lanes + l] = bonds.ends[block * 2 * lanes + lanes + l - 1];
  for (int f = 0; f < n_fields(bonds.n_modes); ++f)
    field(bonds, block, f)[l] = field(bonds, block, f)[l - 1];
  remove_bond(bonds, lane);
}

/// A number of each lane in each row.
using EndRows = double[lanes][lanes];

/// One step of the eight bonds of a block. M: relaxation modes, 0 if known at run time only.
/// \param first, second        motions of the ends
/// \param on_first, on_second  forces and moments on the ends
/// \return lanes that broke, one bit each
template <int M>
unsigned advance_block(double* __restrict block, int n_modes, const StepFactors& factors,
                       double strength_factor, const EndRows& __restrict first,
                       const EndRows& __restrict second, EndRows& __restrict on_first,
                       EndRows& __restrict on_second)
{
  const int m = M > 0 ? M : n_modes;
  double* __restrict f = block + modes * lanes;
  const double* __restrict c = f + 6 * m * lanes;
  double du[6][lanes], total[6][lanes], frame[9][lanes], arms[2][lanes];
#pragma omp simd
  for (int l = 0; l < lanes; ++l) {
    const double nx = block[l], ny = block[lanes + l], nz = block[2 * lanes + l];
    const double d = block[3 * lanes + l];
    const double tx = block[4 * lanes + l], ty = block[5 * lanes + l], tz = block[6 * lanes + l];
    const double rx = second[0][l] - first[0][l], ry = second[1][l] - first[1][l],
                 rz = second[2][l] - first[2][l];
    const double length = std::sqrt(rx * rx + ry * ry + rz * rz), inverse = 1 / length;
    const double mx = rx * inverse, my = ry * inverse, mz = rz * inverse; // new normal
    // relative motion at the contact point, in the middle of the step
    const double half = c[offset * lanes + l] * inverse, wa = 0.5 + half, wb = 0.5 - half;
    const double hx = wa * first[3][l] + wb * second[3][l],
                 hy = wa * first[4][l] + wb * second[4][l],
                 hz = wa * first[5][l] + wb * second[5][l];
    const double ox = d * nx, oy = d * ny, oz = d * nz;
    const double sx = rx + ox, sy = ry + oy, sz = rz + oz;
    const double vx = rx - ox - (hy * sz - hz * sy), vy = ry - oy - (hz * sx - hx * sz),
                 vz = rz - oz - (hx * sy - hy * sx);
    const double px = 2 * (second[3][l] - first[3][l]), py = 2 * (second[4][l] - first[4][l]),
                 pz = 2 * (second[5][l] - first[5][l]);
    // the tangent: swing between the normals, then twist by the mean rotation
    const double swing = (tx * mx + ty * my + tz * mz) / (1 + nx * mx + ny * my + nz * mz);
    double ax = tx - swing * (nx + mx), ay = ty - swing * (ny + my), az = tz - swing * (nz + mz);
    const double twist =
        0.5 * ((first[3][l] + second[3][l]) * nx + (first[4][l] + second[4][l]) * ny +
               (first[5][l] + second[5][l]) * nz);
    const double scale = 1 / (1 + twist * twist), cosine = (1 - twist * twist) * scale,
                 sine = 2 * twist * scale;
    const double bx = my * az - mz * ay, by = mz * ax - mx * az, bz = mx * ay - my * ax;
    ax = cosine * ax + sine * bx;
    ay = cosine * ay + sine * by;
    az = cosine * az + sine * bz;
    const double off = ax * mx + ay * my + az * mz; // rounding away from a right angle and length 1
    ax -= off * mx;
    ay -= off * my;
    az -= off * mz;
    const double unit = 1.5 - 0.5 * (ax * ax + ay * ay + az * az);
    ax *= unit;
    ay *= unit;
    az *= unit;
    const double cx = my * az - mz * ay, cy = mz * ax - mx * az, cz = mx * ay - my * ax;

    du[0][l] = c[k_normal * lanes + l] * (length - d);
    du[1][l] = c[k_shear * lanes + l] * (vx * ax + vy * ay + vz * az);
    du[2][l] = c[k_shear * lanes + l] * (vx * cx + vy * cy + vz * cz);
    du[3][l] = c[k_torsion * lanes + l] * (px * mx + py * my + pz * mz);
    du[4][l] = c[k_bending * lanes + l] * (px * ax + py * ay + pz * az);
    du[5][l] = c[k_bending * lanes + l] * (px * cx + py * cy + pz * cz);
    block[l] = frame[0][l] = mx;
    block[lanes + l] = frame[1][l] = my;
    block[2 * lanes + l] = frame[2][l] = mz;
    block[3 * lanes + l] = length;
    block[4 * lanes + l] = frame[3][l] = ax;
    block[5 * lanes + l] = frame[4][l] = ay;
    block[6 * lanes + l] = frame[5][l] = az;
    frame[6][l] = cx;
    frame[7][l] = cy;
    frame[8][l] = cz;
    arms[0][l] = wa * length;
    arms[1][l] = wb * length;
  }
  for (int component = 0; component < 6; ++component) {
#pragma omp simd
    for (int l = 0; l < lanes; ++l) {
      double sum = 0;
      for (int i = 0; i < m; ++i) {
        double& mode = f[i * lanes + l];
        mode = factors.decay[i] * mode + factors.gain[i] * du[component][l];
        sum += mode;
      }
      total[component][l] = sum;
    }
    f += m * lanes;
  }
  const double squared_factor = strength_factor * strength_factor;
  double broken[lanes]; // > 0 if so
#pragma omp simd
  for (int l = 0; l < lanes; ++l) {
    const double nx = frame[0][l], ny = frame[1][l], nz = frame[2][l];
    const double fx = total[0][l] * nx + total[1][l] * frame[3][l] + total[2][l] * frame[6][l];
    const double fy = total[0][l] * ny + total[1][l] * frame[4][l] + total[2][l] * frame[7][l];
    const double fz = total[0][l] * nz + total[1][l] * frame[5][l] + total[2][l] * frame[8][l];
    const double tx = total[3][l] * nx + total[4][l] * frame[3][l] + total[5][l] * frame[6][l];
    const double ty = total[3][l] * ny + total[4][l] * frame[4][l] + total[5][l] * frame[7][l];
    const double tz = total[3][l] * nz + total[4][l] * frame[5][l] + total[5][l] * frame[8][l];
    const double qx = ny * fz - nz * fy, qy = nz * fx - nx * fz, qz = nx * fy - ny * fx;
    const double la = arms[0][l], lb = arms[1][l];
    on_first[0][l] = fx;
    on_first[1][l] = fy;
    on_first[2][l] = fz;
    on_first[3][l] = tx + la * qx;
    on_first[4][l] = ty + la * qy;
    on_first[5][l] = tz + la * qz;
    on_second[0][l] = -fx;
    on_second[1][l] = -fy;
    on_second[2][l] = -fz;
    on_second[3][l] = lb * qx - tx;
    on_second[4][l] = lb * qy - ty;
    on_second[5][l] = lb * qz - tz;
    const double shear = total[1][l] * total[1][l] + total[2][l] * total[2][l];
    const double s = c[s_shear * lanes + l];
    const double pull = total[0][l] - strength_factor * c[s_normal * lanes + l];
    broken[l] = std::max(pull, shear - squared_factor * s * s);
  }
  unsigned mask = 0;
  for (int l = 0; l < lanes; ++l)
    mask |= unsigned(broken[l] > 0) << l;
  return mask;
}

using BlockKernel = unsigned (*)(double*, int, const StepFactors&, double, const EndRows&,
                                 const EndRows&, EndRows&, EndRows&);

BlockKernel kernel_for(int n_modes)
{
  constexpr std::array<BlockKernel, 5> known{advance_block<0>, advance_block<1>, advance_block<2>,
                                             advance_block<3>, advance_block<4>};
  return known[n_modes < int(known.size()) ? n_modes : 0];
}

} // namespace

StepFactors step_factors(const CreepLaw& law, double dt, int n_modes)
{
  StepFactors result{std::vector<double>(n_modes, 0.0), std::vector<double>(n_modes, 0.0)};
  const auto spectrum = relaxation_spectrum(law);
  for (std::size_t i = 0; i < spectrum.size(); ++i) {
    const double x = spectrum[i].rate * dt;
    result.decay[i] = std::exp(-x);
    result.gain[i] = spectrum[i].stiffness / law.maxwell_stiffness * phi1(x);
  }
  return result;
}

DynamicBonds make_dynamic_bonds(const Assembly& assembly, std::span<const Index> slot, int n_modes)
{
  DynamicBonds bonds;
  bonds.n_modes = n_modes;
  const std::vector<Index> order = sorted_bonds(assembly, slot);
  const Index per_chunk =
      std::max<Index>(2048, Index(order.size() / 32) + 1) / lanes * lanes; // at most 32 chunks
  for (std::size_t begin = 0; begin < order.size(); begin += per_chunk) {
    std::vector<Index> members(order.begin() + begin,
                               order.begin() + std::min(order.size(), begin + per_chunk));
    std::ranges::stable_sort(members, {}, [&](Index b) { return assembly.bonds.law[b]; });
    BondChunk chunk{bonds.n_blocks(), 0, std::numeric_limits<Index>::max(), 0,
                    bonds.n_partial_forces};
    int lane = lanes; // next free lane of the last block
    for (const Index b : members) {
      const int law = assembly.bonds.law[b];
      const bool fresh = bonds.n_blocks() == chunk.first_block;
      if (lane == lanes || fresh || bonds.law.back() != law) {
        bonds.law.push_back(law);
        bonds.ends.resize(bonds.ends.size() + 2 * lanes, 0);
        bonds.bond.resize(bonds.bond.size() + lanes, -1);
        bonds.fields.resize(bonds.fields.size() + n_fields(n_modes) * lanes, 0.0);
        lane = 0;
      }
      const Index block = bonds.n_blocks() - 1;
      for (int end = 0; end < 2; ++end) {
        const Index s = slot[assembly.bonds.ends[b][end]];
        bonds.ends[block * 2 * lanes + end * lanes + lane] = s;
        chunk.first_particle = std::min(chunk.first_particle, s);
        chunk.last_particle = std::max(chunk.last_particle, s + 1);
      }
      bonds.bond[block * lanes + lane] = b;
      fill_lane(bonds, assembly, block * lanes + lane, b);
      ++lane;
    }
    chunk.last_block = bonds.n_blocks();
    bonds.n_partial_forces += std::size_t(chunk.last_particle - chunk.first_particle);
    bonds.chunks.push_back(chunk);
  }
  for (std::size_t lane = 0; lane < bonds.bond.size(); ++lane)
    if (bonds.bond[lane] < 0)
      fill_idle_lane(bonds, Index(lane));
  return bonds;
}

void advance_chunk(DynamicBonds& bonds, const BondChunk& chunk, const double* motions,
                   std::span<const StepFactors> factors, double strength_factor, double* partial,
                   std::vector<Index>& broken)
{
  const BlockKernel kernel = kernel_for(bonds.n_modes);
  // offset so that slots can be used as they are
  double* window = partial + (std::ptrdiff_t(chunk.window) - chunk.first_particle) * force_stride;
  std::fill_n(partial + chunk.window * force_stride,
              std::size_t(chunk.last_particle - chunk.first_particle) * force_stride, 0.0);
  // The ends of several blocks are fetched together, ahead of the arithmetic.
  constexpr Index batch = 8;
  struct BlockRows {
    EndRows first, second, on_first = {}, on_second = {};
  };
  alignas(64) BlockRows rows[batch];
  alignas(64) EndRows turned;
  for (Index begin = chunk.first_block; begin < chunk.last_block; begin += batch) {
    const Index end = std::min(chunk.last_block, begin + batch);
    for (Index block = begin; block < end; ++block)
      for (int side = 0; side < 2; ++side) {
        const Index* slot = bonds.ends.data() + std::size_t(2 * block + side) * lanes;
        std::array<const double*, lanes> at;
        for (int l = 0; l < lanes; ++l)
          at[l] = motions + std::size_t(slot[l]) * motion_stride;
        transpose8(at, side == 0 ? rows[block - begin].first : rows[block - begin].second);
      }
    for (Index block = begin; block < end; ++block) {
      BlockRows& row = rows[block - begin];
      const unsigned mask =
          kernel(field(bonds, block, 0), bonds.n_modes, factors[bonds.law[block]], strength_factor,
                 row.first, row.second, row.on_first, row.on_second);
      for (int l = 0; mask >> l; ++l)
        if (mask >> l & 1)
          broken.push_back(block * lanes + l);
    }
    for (Index block = begin; block < end; ++block)
      for (int side = 0; side < 2; ++side) {
        const Index* slot = bonds.ends.data() + std::size_t(2 * block + side) * lanes;
        const EndRows& on =
            side == 0 ? rows[block - begin].on_first : rows[block - begin].on_second;
        transpose8({on[0], on[1], on[2], on[3], on[4], on[5], on[6], on[7]}, turned);
        for (int l = 0; l < lanes; ++l)
          add8(window + std::size_t(slot[l]) * force_stride, turned[l]);
      }
  }
}

DynamicBond dynamic_bond(const DynamicBonds& bonds, Index lane)
{
  const Index block = lane / lanes, l = lane % lanes;
  const auto get = [&](int which) { return field(bonds, block, which)[l]; };
  const auto get_constant = [&](Constant which) { return get(constant(bonds.n_modes, which)); };
  DynamicBond result{bonds.ends[block * 2 * lanes + l],
                     bonds.ends[block * 2 * lanes + lanes + l],
                     bonds.bond[lane],
                     bonds.law[block],
                     Vec3(get(normal), get(normal + 1), get(normal + 2)),
                     Vec3(get(tangent), get(tangent + 1), get(tangent + 2)),
                     get(distance),
                     {},
                     {get_constant(k_normal), get_constant(k_shear), get_constant(k_torsion),
                      get_constant(k_bending)},
                     get_constant(s_normal),
                     get_constant(s_shear)};
  result.modes.resize(6, bonds.n_modes);
  for (int component = 0; component < 6; ++component)
    for (int i = 0; i < bonds.n_modes; ++i)
      result.modes(component, i) = get(modes + component * bonds.n_modes + i);
  return result;
}

GlobalLoad global_load(const DynamicBond& bond)
{
  const Eigen::Matrix<double, 6, 1> total = bond.modes.rowwise().sum();
  const Vec3 second = bond.normal.cross(bond.tangent);
  return {total[0] * bond.normal + total[1] * bond.tangent + total[2] * second,
          total[3] * bond.normal + total[4] * bond.tangent + total[5] * second};
}

void set_stiffness(DynamicBonds& bonds, Index lane, const ModeStiffness& stiffness)
{
  const Index block = lane / lanes, l = lane % lanes;
  const auto set = [&](Constant which, double value) {
    field(bonds, block, constant(bonds.n_modes, which))[l] = value;
  };
  set(k_normal, stiffness.normal);
  set(k_shear, stiffness.shear);
  set(k_torsion, stiffness.torsion);
  set(k_bending, stiffness.bending);
}

void remove_bond(DynamicBonds& bonds, Index lane)
{
  const Index block = lane / lanes, l = lane % lanes;
  for (int which = 0; which < 6 * bonds.n_modes; ++which)
    field(bonds, block, modes + which)[l] = 0;
  set_stiffness(bonds, lane, {0, 0, 0, 0});
  for (const Constant which : {s_normal, s_shear})
    field(bonds, block, constant(bonds.n_modes, which))[l] = infinity;
}

} // namespace dem
