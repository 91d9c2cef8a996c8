"""Times Embree on the rays of examples/rays.rs, each half in a process of its own.

Arguments: a folder with `triangles.f32` (nine floats each) and `primary.f32`, `diffuse.f32`, `any-hit.f32` (origin, t_min, direction,
t_max each). For each name of rays on a line of standard input, prints the seconds that the slower half took.
"""

import multiprocessing
import sys
import time
from pathlib import Path

import numpy
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

KINDS = {"primary": "INTERSECT", "diffuse": "INTERSECT", "any-hit": "OCCLUDED"}
THREADS = 2


def serve(folder: Path, half: int, requests, seconds, start) -> None:
    """One process: its own Embree scene, its own share of the rays."""
    triangles = numpy.fromfile(folder / "triangles.f32", numpy.float32).reshape(-1, 3, 3)
    scene = rtcore_scene.EmbreeScene()
    mesh = TriangleMesh(scene, triangles)
    rays = {kind: numpy.array_split(numpy.fromfile(folder / f"{kind}.f32", numpy.float32).reshape(-1, 8), THREADS)[half] for kind in KINDS}
    columns = {kind: [numpy.ascontiguousarray(r[:, part]) for part in (slice(0, 3), slice(4, 7), 7)] for kind, r in rays.items()}
    scene.run(columns["primary"][0][:1], columns["primary"][1][:1])  # builds the tree
    while kind := requests.get():
        origins, directions, t_max = columns[kind]
        start.wait()
        begin = time.perf_counter()
        scene.run(origins, directions, dists=t_max, query=KINDS[kind])
        seconds.put(time.perf_counter() - begin)
    del mesh


def main() -> None:
    start = multiprocessing.Barrier(THREADS)
    requests = [multiprocessing.Queue() for _ in range(THREADS)]
    seconds = multiprocessing.Queue()
    for half in range(THREADS):
        arguments = (Path(sys.argv[1]), half, requests[half], seconds, start)
        multiprocessing.Process(target=serve, args=arguments, daemon=True).start()
    for line in sys.stdin:
        for queue in requests:
            queue.put(line.strip())
        print(max(seconds.get() for _ in range(THREADS)), flush=True)


if __name__ == "__main__":
    main()
