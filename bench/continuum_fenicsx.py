#!/usr/bin/python3
"""The scene scenes/continuum/traction-box.scene by FEniCSx, for bench/continuum.py.

usage: continuum_fenicsx.py HISTORY.csv      prints seconds of the time steps, unknowns, last mean displacement of
                                             the top [mm]

The times of the steps are those of the history. Per step: stress linear in time, exact update of the Burgers
shear at the quadrature points, one solve by conjugate gradients with BoomerAMG of hypre,
to the tolerance that mastic has by default; the preconditioner is kept until the shear has become a fifth
softer, the last increment is the guess.
"""
import csv
import sys
import time

import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc

ORDER, TOLERANCE, PRESSURE = 2, 1e-9, 400e3
EDGES, CELLS = (0.06, 0.06, 0.12), (8, 8, 16)
G_M, ETA_M, G_K, ETA_K, BULK = 100e6, 2e10, 60e6, 1.2e9, 400e6


def main():
    with open(sys.argv[1]) as file:
        times = [float(row["time_s"]) for row in csv.DictReader(file)]
    domain = mesh.create_box(MPI.COMM_WORLD, [np.zeros(3), np.array(EDGES)], CELLS, mesh.CellType.hexahedron)
    space = fem.VectorFunctionSpace(domain, ("Lagrange", ORDER))
    degree = 2 * ORDER + 1
    element = ufl.TensorElement("Quadrature", domain.ufl_cell(), degree, quad_scheme="default", symmetry=True)
    states = fem.FunctionSpace(domain, element)
    dx = ufl.Measure("dx", domain=domain, metadata={"quadrature_degree": degree, "quadrature_scheme": "default"})
    bottom = fem.locate_dofs_geometrical(space, lambda x: np.isclose(x[2], 0))
    held = [fem.dirichletbc(np.zeros(3), bottom, space)]
    faces = mesh.locate_entities_boundary(domain, 2, lambda x: np.isclose(x[2], EDGES[2]))
    tags = mesh.meshtags(domain, 2, np.sort(faces), np.ones(len(faces), dtype=np.int32))
    ds = ufl.Measure("ds", domain=domain, subdomain_data=tags)

    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    increment, total = fem.Function(space), fem.Function(space)
    stress, kelvin = fem.Function(states), fem.Function(states)  # deviator of stress, Kelvin strain
    pressure = fem.Function(states)                              # mean stress times unit tensor
    softness, viscous, retarded, swing = (fem.Constant(domain, 1.0) for _ in range(4))
    load = fem.Constant(domain, -PRESSURE)

    def strain(w):
        return ufl.sym(ufl.grad(w))

    def deviator(e):
        return ufl.dev(e)

    creep = viscous * stress + retarded * (stress / (2 * G_K) - kelvin)
    bilinear = fem.form((ufl.inner(deviator(strain(u)) / softness, deviator(strain(v)))
                         + BULK * ufl.div(u) * ufl.div(v)) * dx)
    linear = fem.form(load * v[2] * ds(1) - ufl.inner(stress + pressure, strain(v)) * dx
                      + ufl.inner(creep / softness, deviator(strain(v))) * dx)
    change = (deviator(strain(increment)) - creep) / softness
    points = element_points(element)
    new_stress = fem.Expression(stress + change, points)
    new_kelvin = fem.Expression(kelvin + retarded * (stress / (2 * G_K) - kelvin) + swing * change / (2 * G_K), points)
    new_pressure = fem.Expression(pressure + BULK * ufl.div(increment) * ufl.Identity(3), points)

    solver = PETSc.KSP().create(domain.comm)
    solver.setType("cg")
    solver.getPC().setType("hypre")  # GAMG turns indefinite here before the residual is small
    solver.setInitialGuessNonzero(True)
    solver.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
    matrix = fem.petsc.create_matrix(bilinear)
    n_steps, start, last = 0, None, 0.0
    right = fem.petsc.create_vector(linear)
    scale = set_up_for = None
    for t in times:
        h = t - last
        x = h * G_K / ETA_K
        swing.value = 0 if x == 0 else 1 - (-np.expm1(-x)) / x  # x phi_2
        retarded.value = -np.expm1(-x)
        viscous.value = h / (2 * ETA_M)
        softness.value = 1 / (2 * G_M) + h / (4 * ETA_M) + swing.value / (2 * G_K)
        matrix.zeroEntries()
        fem.petsc.assemble_matrix(matrix, bilinear, bcs=held)
        matrix.assemble()
        with right.localForm() as local:
            local.set(0)
        fem.petsc.assemble_vector(right, linear)
        fem.petsc.set_bc(right, held)
        solver.setOperators(matrix)
        worn = set_up_for is None or softness.value > 1.25 * set_up_for
        set_up_for = float(softness.value) if worn else set_up_for
        solver.getPC().setReusePreconditioner(not worn)
        scale = scale or right.norm()
        solver.setTolerances(rtol=1e-30, atol=TOLERANCE * scale, max_it=2000)
        solver.solve(right, increment.vector)
        if solver.getConvergedReason() <= 0:
            raise SystemExit("FEniCSx: not solved")
        increment.x.scatter_forward()
        results = []
        for expression in (new_stress, new_kelvin, new_pressure):
            results.append(evaluate(expression, domain))
        for function, values in zip((stress, kelvin, pressure), results):
            function.x.array[:] = values
        total.x.array[:] += increment.x.array
        last = t
        if start is None:  # the first answer sets everything up
            start = time.perf_counter()
        else:
            n_steps += 1
    seconds = time.perf_counter() - start
    top = fem.assemble_scalar(fem.form(total[2] * ds(1))) / (EDGES[0] * EDGES[1])
    print(seconds, space.dofmap.index_map.size_global * 3, -1e3 * top)


def element_points(element):
    """Points of a quadrature element."""
    import basix
    scheme = basix.make_quadrature(basix.CellType.hexahedron, element.degree())
    return scheme[0]


def evaluate(expression, domain):
    """Values at all points as the array of a symmetric quadrature function."""
    cells = np.arange(domain.topology.index_map(3).size_local, dtype=np.int32)
    values = expression.eval(cells).reshape(len(cells), -1, 9)
    return values[:, :, [0, 1, 2, 4, 5, 8]].ravel()


if __name__ == "__main__":
    main()
