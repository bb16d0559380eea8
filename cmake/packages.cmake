# The libraries the project stands on, each under one name.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(OpenMP REQUIRED COMPONENTS CXX)
find_package(Boost 1.74 REQUIRED) # headers: quantiles and root finding
find_package(Threads REQUIRED)

# HDF5 in the flavour of Debian's deal.II: two flavours in one program break it.
set(HDF5_PREFER_PARALLEL ON)
find_package(MPI REQUIRED COMPONENTS C) # its header is part of the HDF5 headers
find_package(HDF5 REQUIRED COMPONENTS C)
if(NOT HDF5_IS_PARALLEL)
  message(FATAL_ERROR "HDF5 with MPI is needed (package libhdf5-openmpi-dev): deal.II links it, "
                      "and two flavours in one program do not work.")
endif()
add_library(project_hdf5 INTERFACE)
target_include_directories(project_hdf5 SYSTEM INTERFACE ${HDF5_INCLUDE_DIRS})
target_link_libraries(project_hdf5 INTERFACE ${HDF5_LIBRARIES} MPI::MPI_C)

# Supernodal CHOLMOD on OpenBLAS: with the reference BLAS it is many times slower.
find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
find_library(OPENBLAS_LIBRARY openblas PATH_SUFFIXES openblas-openmp REQUIRED)
add_library(project_cholmod INTERFACE)
target_include_directories(project_cholmod SYSTEM INTERFACE ${CHOLMOD_INCLUDE_DIR})
target_link_libraries(project_cholmod INTERFACE ${CHOLMOD_LIBRARY} ${OPENBLAS_LIBRARY})
