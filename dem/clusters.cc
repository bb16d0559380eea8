#include "dem/volume_element.h"

#include <Eigen/QR>

#include <algorithm>
#include <limits>

namespace dem {

namespace {

struct Step {
  Index to;
  ImageShift shift;
  bool crosses;
};

std::vector<std::vector<Step>> steps_of(const VolumeElement& element,
                                        std::span<const BondStatus> status)
{
  std::vector<std::vector<Step>> result(element.particles.size());
  for (std::size_t b = 0; b < element.bonds.size(); ++b) {
    if (status[b] == BondStatus::gone)
      continue;
    const auto [i, j] = element.bonds.ends[b];
    const ImageShift& shift = element.shift[b];
    result[i].push_back({j, shift, !shift.isZero()});
    result[j].push_back({i, -shift, !shift.isZero()});
  }
  return result;
}

/// Keeps the direction if it is independent of the others.
void add_direction(std::vector<Vec3>& directions, const Vec3& loop)
{
  Eigen::MatrixXd matrix(3, Eigen::Index(directions.size()) + 1);
  for (std::size_t k = 0; k < directions.size(); ++k)
    matrix.col(Eigen::Index(k)) = directions[k].normalized();
  matrix.rightCols<1>() = loop.normalized();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  qr.setThreshold(1e-9);
  if (qr.rank() == matrix.cols())
    directions.push_back(loop);
}

/// Offsets such that as many bonds as a spanning tree has cross no face. Bonds inside the cell are
/// followed first, so that a particle moves only if it hangs on others by bonds across faces alone.
void walk(const std::vector<std::vector<Step>>& steps, Index start, Cluster& cluster,
          std::vector<ImageShift>& offset, std::vector<bool>& reached)
{
  std::vector<Index> crossing{start}; // reached, steps across faces still to be looked at
  std::size_t next = 0;
  const auto reach = [&](Index i, const ImageShift& at) {
    std::vector<Index> inside{i};
    offset[i] = at;
    reached[i] = true;
    for (std::size_t k = 0; k < inside.size(); ++k)
      for (const Step& step : steps[inside[k]])
        if (!step.crosses && !reached[step.to]) {
          reached[step.to] = true;
          offset[step.to] = at;
          inside.push_back(step.to);
        }
    cluster.particles.insert(cluster.particles.end(), inside.begin(), inside.end());
    return inside;
  };
  crossing = reach(start, ImageShift::Zero());
  for (; next < crossing.size(); ++next)
    for (const Step& step : steps[crossing[next]])
      if (step.crosses && !reached[step.to])
        for (const Index i : reach(step.to, offset[crossing[next]] + step.shift))
          crossing.push_back(i);
}

} // namespace

Clusters find_clusters(const VolumeElement& element, std::span<const BondStatus> status)
{
  const std::size_t n = element.particles.size();
  const auto steps = steps_of(element, status);
  Clusters result{{}, std::vector<ImageShift>(n, ImageShift::Zero())};
  std::vector<bool> reached(n, false);
  for (Index i = 0; i < Index(n); ++i) {
    if (reached[i])
      continue;
    Cluster& cluster = result.cluster.emplace_back();
    walk(steps, i, cluster, result.offset, reached);
    std::ranges::sort(cluster.particles);
    for (const Index from : cluster.particles)
      for (const Step& step : steps[from]) {
        const ImageShift loop = result.offset[from] + step.shift - result.offset[step.to];
        if (!loop.isZero() && cluster.direction.size() < 3)
          add_direction(cluster.direction, element.cell.translation(loop));
      }
  }
  return result;
}

VolumeElement with_whole_clusters(VolumeElement element)
{
  const std::vector<BondStatus> intact(element.bonds.size(), BondStatus::intact);
  const Clusters clusters = find_clusters(element, intact);
  for (std::size_t i = 0; i < element.particles.size(); ++i)
    element.particles.centre[i] += element.cell.translation(clusters.offset[i]);
  for (std::size_t b = 0; b < element.bonds.size(); ++b) {
    const auto [i, j] = element.bonds.ends[b];
    element.shift[b] += clusters.offset[i] - clusters.offset[j];
  }
  return element;
}

} // namespace dem
