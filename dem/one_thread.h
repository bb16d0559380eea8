#pragma once
#include <omp.h>

extern "C" {
void openblas_set_num_threads(int);
int openblas_get_num_threads();
}

namespace dem {

/// Everything on one thread while it lives: OpenBLAS, whose sums depend on the number of threads,
/// and parallel regions of OpenMP, such as those that CHOLMOD and Eigen open for loops so short
/// that waking threads takes longer. OpenBLAS has one number for the whole program: who starts
/// threads that solve networks side by side must hold one of these around them.
struct OneThread {
  int blas = openblas_get_num_threads(), levels = omp_get_max_active_levels();
  OneThread()
  {
    openblas_set_num_threads(1);
    omp_set_max_active_levels(0);
  }
  ~OneThread()
  {
    openblas_set_num_threads(blas);
    omp_set_max_active_levels(levels);
  }
  OneThread(const OneThread&) = delete;
};

} // namespace dem
