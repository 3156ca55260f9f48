"""Compares light scattered once in a slab of flakes with Mitsuba 3 (pip install mitsuba).

    cargo run --release -p fieldstone-texel --example slab > slab.json
    python crates/texel/benches/mitsuba_slab.py slab.json

Mitsuba has flakes that are mirrors; its path tracer ends after one scattering here. It needs projected areas of at most 1:
flakes shrink and their number grows. Exits with 1 where means differ by more than 2 %.
"""

import json
import sys

import mitsuba as mi
import numpy as np

LIMIT = 0.02
SAMPLES = 1024
PIXELS = 32


def media(slab):
    edge = slab["edge"]
    cells = np.array(slab["cells"]).reshape(edge, edge, edge, 4)
    density, areas = cells[..., :1], cells[..., 1:]
    greatest = areas.max()
    flakes = np.concatenate([areas / greatest, np.zeros_like(areas)], axis=-1)

    def grid(data):
        data = np.ascontiguousarray(data, dtype=np.float32)
        return {"type": "gridvolume", "grid": mi.VolumeGrid(data), "raw": True, "filter_type": "nearest"}

    return {
        "type": "heterogeneous",
        "sigma_t": grid(density * np.sqrt(greatest)),
        "albedo": {"type": "constvolume", "value": slab["albedo"]},
        "phase": {"type": "sggx", "S": grid(flakes)},
    }


def radiance(slab, view, light, seed):
    to_world = mi.ScalarTransform4f
    middle = np.array([0.5, 0.5, 0.25])
    side = np.cross(view, [0.0, 1.0, 0.0] if abs(view[1]) < 0.7 else [1.0, 0.0, 0.0])
    camera = to_world().look_at(origin=list(middle + 2 * np.array(view)), target=list(middle), up=list(side))
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": 2, "rr_depth": 100},
        "sensor": {
            "type": "orthographic",
            "to_world": camera @ to_world().scale([slab["half_width"], slab["half_width"], 1.0]),
            "film": {"type": "hdrfilm", "width": PIXELS, "height": PIXELS, "rfilter": {"type": "box"}},
            "sampler": {"type": "independent", "sample_count": SAMPLES},
        },
        "light": {"type": "directional", "direction": [-x for x in light], "irradiance": 1.0},
        "slab": {
            "type": "cube",
            "to_world": to_world().translate([0.5, 0.5, 0.5]).scale([0.5, 0.5, 0.5]),
            "bsdf": {"type": "null"},
            "interior": media(slab),
        },
    })
    picture = np.array(mi.render(scene, seed=seed))[..., 0]
    return picture.mean()


def main():
    mi.set_variant("scalar_rgb")
    with open(sys.argv[1], encoding="utf-8") as file:
        slab = json.load(file)
    worst = 0.0
    for seed, case in enumerate(slab["views"]):
        other = radiance(slab, case["view"], case["light"], seed)
        error = case["radiance"] / other - 1
        worst = max(worst, abs(error))
        print(f"view {case['view']} light {case['light']}: {case['radiance']:.6f} beside {other:.6f}, {100 * error:+.2f} %")
    sys.exit(int(worst > LIMIT))


main()
