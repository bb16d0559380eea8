"""The bonded cylinder in Yade, stepped on demand; started by peer.py with `yade -x`.

Reads data/cylinder.* from the folder BENCH_DATA. Then runs as many steps as each line of the input
says and answers with the seconds they took and the force on the upper platen. Bonds are Yade's
cohesive frictional contacts with moments (its total form), which stay elastic here.
"""
import csv
import json
import math
import os
import sys
import time

folder = os.environ["BENCH_DATA"]
scene = json.load(open(os.path.join(folder, "cylinder.json")))


def rows(name):
    lines = csv.reader(open(os.path.join(folder, name)))
    next(lines)
    return list(lines)


def add_spheres():
    """Spheres of the packing; those near the ends are held. Returns the upper ones."""
    strong = 1e12  # [Pa], cohesion: checked at every step, never reached
    O.materials.append(CohFrictMat(
        density=scene["density_kg_m3"], young=1e9, poisson=0.5, frictionAngle=0.5, isCohesive=True,
        normalCohesion=strong, shearCohesion=strong, momentRotationLaw=True, etaRoll=-1, etaTwist=-1))
    spheres = [tuple(map(float, row)) for row in rows("cylinder.particles.csv")]
    height, depth = max(z + r for _, _, z, r in spheres), scene["platen_depth_m"]
    upper = []
    for x, y, z, r in spheres:
        number = O.bodies.append(sphere((x, y, z), r))
        if depth <= z <= height - depth:
            continue
        state = O.bodies[number].state
        state.blockedDOFs = "xyzXYZ"
        if z > height - depth:
            state.vel = (0, 0, -scene["platen_speed_m_s"])
            upper.append(number)
    return spheres, upper


def reach(spheres, pairs):
    """Largest distance of a bonded pair over the sum of its radii: finds all bonds by search."""
    ratios = (math.dist(spheres[i][:3], spheres[j][:3]) / (spheres[i][3] + spheres[j][3])
              for i, j in pairs)
    return max(ratios) * (1 + 1e-9)


def make_bonds(reach_factor):
    """Searches with an enlarged reach in a step of no length, then sets what every bond is."""
    bound = Bo1_Sphere_Aabb(aabbEnlargeFactor=reach_factor)
    geometry = Ig2_Sphere_Sphere_ScGeom6D(interactionDetectionFactor=reach_factor)
    physics = Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True)
    law = Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=True,
                                                    useIncrementalForm=False)
    O.engines = [ForceResetter(), InsertionSortCollider([bound], verletDist=5e-4),
                 InteractionLoop([geometry], [physics], [law]),
                 NewtonIntegrator(damping=0, gravity=(0, 0, 0))]
    O.dt = 1e-30
    O.step()
    physics.setCohesionNow = False
    bound.aabbEnlargeFactor = geometry.interactionDetectionFactor = -1
    for bond in O.interactions:
        bond.phys.kn, bond.phys.ks = scene["normal_stiffness_N_m"], scene["shear_stiffness_N_m"]
        bond.phys.kr, bond.phys.ktw = scene["bending_stiffness_N_m"], scene["torsion_stiffness_N_m"]
        bond.phys.unp = bond.geom.penetrationDepth  # no force at the initial distance
        bond.phys.shearForce = (0, 0, 0)
        bond.phys.unpMax = -1
    O.dt = scene["time_step_s"]


spheres, upper = add_spheres()
pairs = [tuple(map(int, row)) for row in rows("cylinder.bonds.csv")]
make_bonds(reach(spheres, pairs))
print("ready bonds", sum(1 for each in O.interactions if each.isReal), flush=True)
for line in sys.stdin:
    begin = time.perf_counter()
    O.run(int(line), True)
    seconds = time.perf_counter() - begin
    force = sum(O.forces.f(number)[2] for number in upper)
    print(f"done seconds {seconds:.6f} force {force:.6f}", flush=True)
os._exit(0)  # without the interpreter that follows a script
