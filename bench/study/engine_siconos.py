"""One scene of the study "engines" by Siconos (Acary et al.; python3-siconos): JSON in, JSON out.

Moreau-Jean steps of its mechanics module, contacts by its Bullet (single precision in Debian), impulses by projected
Gauss-Seidel (NSGS) on the round cone to 1e-10 or as many sweeps as asked for. Exit code 3: Siconos is not here.
"""

import json
import os
import sys
import time

try:
    import numpy
    import siconos.kernel as kernel
    import siconos.numerics as numerics
    from siconos.mechanics.collision import (RigidBodyDS, SiconosBox, SiconosContactor, SiconosContactorSet,
                                             SiconosConvexHull)
    from siconos.mechanics.collision.bullet import SiconosBulletCollisionManager, SiconosBulletOptions
except ImportError:
    sys.exit(3)


def contactors(shape, group, margin):
    shape.setInsideMargin(margin)
    out = SiconosContactorSet()
    out.append(SiconosContactor(shape, [0, 0, 0, 1, 0, 0, 0], group))
    return out


def shape_of(body):
    if body["sides"]:
        return SiconosBox(body["sides"])
    return SiconosConvexHull(numpy.array(body["vertices"], dtype=float))


def run(scene):
    step = scene["step"]
    end = scene["times"][-1] + 10 * step
    options = SiconosBulletOptions()
    options.contactBreakingThreshold = scene["breaking"]
    options.worldScale = scene["scale"]
    options.clearOverlappingPairCache = scene["afresh"]
    manager = SiconosBulletCollisionManager(options)
    frictions = sorted({b["friction"] for b in scene["bodies"] + scene["floors"]})
    for i, low in enumerate(frictions):
        for j in range(i, len(frictions)):
            law = kernel.NewtonImpactFrictionNSL(scene["restitution"], 0.0, low, 3)
            manager.insertNonSmoothLaw(law, i, j)
            if i != j:
                manager.insertNonSmoothLaw(law, j, i)
    model = kernel.NonSmoothDynamicalSystem(0, end)
    bodies = []
    for b in scene["bodies"]:
        body = RigidBodyDS(b["at"] + b["turn"], b["velocity"] + b["spin"], b["mass"], numpy.array(b["inertia"]))
        body.setContactors(contactors(shape_of(b), frictions.index(b["friction"]), b["margin"]))
        body.setFExtPtr([b["mass"] * g for g in scene["gravity"]])
        model.insertDynamicalSystem(body)
        bodies.append(body)
    kept = []
    for f in scene["floors"]:
        kept.append(contactors(SiconosBox([200, 200, 1]), frictions.index(f["friction"]), 0.1))
        manager.insertStaticContactorSet(kept[-1], f["at"] + f["turn"])
    osi = kernel.MoreauJeanOSI(scene["theta"])
    impulses = kernel.FrictionContact(3, numerics.SICONOS_FRICTION_3D_NSGS)
    impulses.numericsSolverOptions().iparam[0] = scene["iterations"]
    impulses.numericsSolverOptions().dparam[0] = 1e-10
    impulses.setMaxSize(65536)
    impulses.setMStorageType(1)  # sparse
    impulses.setNumericsVerboseMode(False)
    impulses.setKeepLambdaAndYState(True)
    simulation = kernel.TimeStepping(model, kernel.TimeDiscretisation(0, step), osi, impulses)
    simulation.insertInteractionManager(manager)
    simulation.setNewtonMaxIteration(10)
    simulation.setNewtonTolerance(1e-10)
    simulation.setWarnOnNonConvergence(False)
    frames, taken, wall, cpu = [], 0, 0.0, 0.0
    for at in scene["times"]:
        start, spent = time.perf_counter(), time.process_time()
        while taken < round(at / step):
            simulation.computeOneStep()
            simulation.nextStep()
            taken += 1
        wall += time.perf_counter() - start
        cpu += time.process_time() - spent
        frames.append([[float(x) for x in b.q()] + [float(x) for x in b.velocity()] for b in bodies])
    return {"frames": frames, "wall": wall, "cpu": cpu}


def main():
    if len(sys.argv) == 1:
        return
    with open(sys.argv[1], encoding="utf-8") as file:
        scene = json.load(file)
    # The library talks on the standard output.
    said = os.dup(1)
    os.dup2(2, 1)
    answer = run(scene)
    os.write(said, json.dumps(answer).encode())


main()
