#include "fem/field_files.h"

#include "fem/mandel.h"

#include <deal.II/base/data_out_base.h>
#include <deal.II/numerics/data_out.h>
#include <fmt/format.h>

#include <array>
#include <fstream>
#include <stdexcept>

namespace fem {

namespace {

/// Means over the cells of a rank.
template <int dim>
std::vector<Vec6> cell_means(const Elements<dim>& elements, std::span<const Vec6> field)
{
  const std::size_t n_q = elements.points_per_cell();
  std::vector<Vec6> means(elements.n_cells(), Vec6::Zero());
  for (std::size_t cell = 0; cell < means.size(); ++cell) {
    double volume = 0;
    for (std::size_t q = cell * n_q; q < (cell + 1) * n_q; ++q) {
      means[cell] += elements.weights()[q] * field[q];
      volume += elements.weights()[q];
    }
    means[cell] /= volume;
  }
  return means;
}

double von_mises(const Vec6& stress)
{
  Vec6 deviator = stress;
  deviator.head<3>().array() -= stress.head<3>().mean();
  return std::sqrt(1.5) * deviator.norm();
}

const std::array<const char*, 6> names{"xx", "yy", "zz", "yz", "xz", "xy"};

} // namespace

template <int dim>
void write_fields(const std::filesystem::path& file, const Specimen<dim>& specimen,
                  const MaterialPoints& points, std::span<const CellField> others)
{
  const Elements<dim>& elements = specimen.elements();
  const auto& cells = elements.dofs().get_triangulation();
  const std::vector<Vec6> strain = cell_means(elements, points.strain());
  const std::vector<Vec6> stress = cell_means(elements, points.stress());
  std::vector<dealii::Vector<double>> columns(15 + others.size(),
                                              dealii::Vector<double>(cells.n_active_cells()));
  std::size_t own = 0;
  for (const auto& cell : elements.dofs().active_cell_iterators())
    if (cell->is_locally_owned()) {
      const unsigned at = cell->active_cell_index();
      const Vec6 e = tensor_components(strain[own]), s = tensor_components(stress[own]);
      for (unsigned c = 0; c < 6; ++c) {
        columns[c][at] = e[c];
        columns[6 + c][at] = s[c];
      }
      columns[12][at] = s.head<3>().mean();
      columns[13][at] = von_mises(stress[own]);
      columns[14][at] = double(cell->material_id());
      for (std::size_t k = 0; k < others.size(); ++k)
        columns[15 + k][at] = others[k].values[own];
      ++own;
    }
  dealii::DataOut<dim> output;
  output.attach_dof_handler(elements.dofs());
  using dealii::DataComponentInterpretation::component_is_part_of_vector;
  if constexpr (dim == 3)
    output.add_data_vector(specimen.displacement(), std::vector<std::string>(3, "displacement_m"),
                           dealii::DataOut<dim>::type_dof_data,
                           std::vector(3, component_is_part_of_vector));
  else
    output.add_data_vector(specimen.displacement(),
                           std::vector<std::string>{"displacement_r_m", "displacement_z_m"});
  for (unsigned c = 0; c < 6; ++c) {
    output.add_data_vector(columns[c], fmt::format("strain_{}", names[c]));
    output.add_data_vector(columns[6 + c], fmt::format("stress_{}_Pa", names[c]));
  }
  output.add_data_vector(columns[12], "mean_stress_Pa");
  output.add_data_vector(columns[13], "von_mises_stress_Pa");
  output.add_data_vector(columns[14], "region");
  for (std::size_t k = 0; k < others.size(); ++k)
    output.add_data_vector(columns[15 + k], others[k].name);
  dealii::DataOutBase::VtkFlags flags;
  flags.write_higher_order_cells = elements.discretisation().order > 1;
  output.set_flags(flags);
  output.build_patches(elements.mapping(), unsigned(elements.discretisation().order),
                       dealii::DataOut<dim>::curved_inner_cells);
  const std::filesystem::path temporary = file.string() + ".part";
  output.write_vtu_in_parallel(temporary.string(), elements.ranks());
  std::error_code failed;
  if (dealii::Utilities::MPI::this_mpi_process(elements.ranks()) == 0)
    std::filesystem::rename(temporary, file, failed);
  if (dealii::Utilities::MPI::max(int(bool(failed)), elements.ranks()) == 1)
    throw std::runtime_error(fmt::format("{} cannot be written", file.string()));
}

void write_series(const std::filesystem::path& file,
                  const std::vector<std::pair<double, std::string>>& times_and_files)
{
  const std::filesystem::path temporary = file.string() + ".part";
  {
    std::ofstream stream(temporary);
    dealii::DataOutBase::write_pvd_record(stream, times_and_files);
    if (!stream.flush())
      throw std::runtime_error(fmt::format("{} cannot be written", file.string()));
  }
  std::filesystem::rename(temporary, file);
}

template void write_fields(const std::filesystem::path&, const Specimen<2>&, const MaterialPoints&,
                           std::span<const CellField>);
template void write_fields(const std::filesystem::path&, const Specimen<3>&, const MaterialPoints&,
                           std::span<const CellField>);

} // namespace fem
