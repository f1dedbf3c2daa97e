"""What matters on a pyvista mesh, and a tenth of it that keeps that.

python pyvista_saliency.py [MODEL]
"""

import sys

import numpy as np

import karui

try:
    import pyvista
except ImportError:
    sys.exit("this example needs pyvista: pip install pyvista")


def main() -> None:
    surface = (
        pyvista.read(sys.argv[1]).extract_surface(algorithm="dataset_surface")
        if len(sys.argv) > 1
        else pyvista.ParametricRandomHills(random_seed=1, u_res=200, v_res=200)
    )
    surface = surface.triangulate().clean()
    surface["saliency"] = karui.saliency(surface)
    weights = karui.saliency_weights(surface["saliency"])
    for name, coarse in (
        ("everywhere alike", karui.simplify(surface, ratio=0.1)),
        ("by saliency", karui.simplify(surface, ratio=0.1, weights=weights)),
    ):
        off = karui.vertex_distances(surface, coarse.mesh)
        salient = surface["saliency"] > np.quantile(surface["saliency"], 0.9)
        print(
            f"{len(coarse.mesh.triangles):7,} of {surface.n_cells:,} triangles, {name}: "
            f"{off[salient].mean():.2e} off where it matters, {off.mean():.2e} in all"
        )
    back = pyvista.PolyData.from_regular_faces(coarse.mesh.positions, coarse.mesh.triangles)
    print(f"{len(back.points):,} points again in pyvista")


main()
