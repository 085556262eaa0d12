#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Saves a picture of a result file: the deformed bodies, and beside them the contact surfaces with the
state of every node (open, slip, stick), each laid flat and seen from outside its body.

    haptos_view.py RESULT.exo [--field von_mises] [--scale auto] [--block NAME]... [--step N]
                   [--view isometric|x|y|z|-x|-y|-z] [--no-contact] [--edges] [--output PICTURE.png]

--field    an element or nodal field of the file: von_mises, contact_pressure, subdomain, displacement
           (its length), displacement_x, ...; "none" colours the bodies by block
--scale    the displacement is drawn this many times larger; "auto" makes the largest 3 % of the model's size

Needs the Python package pyvista; on Debian also apt-get install libgl1 libxrender1.
"""
import argparse
import pathlib
import sys

import numpy as np
import pyvista

STATUS_NAMES = {1: "open", 2: "slip", 3: "stick"}
STATUS_COLOURS = ["#c8c8c8", "#e0862c", "#2a6fb0"]
BLOCK_COLOURS = ["#8fb3d9", "#d9b48f", "#a8cfa0", "#c9a0cf", "#cfcb90"]
CAMERA = {"isometric": (1.0, 0.75, 1.3), "x": (1, 0, 0), "y": (0, 1, 1e-3), "z": (0, 0, 1),
          "-x": (-1, 0, 0), "-y": (0, -1, 1e-3), "-z": (0, 0, -1)}


class ViewError(Exception):
    """The picture cannot be made from this file with these options."""


def read_blocks(path, step):
    """{block name: grid} at the given step (from 1; 0 is the last), undeformed, with all fields."""
    if not pathlib.Path(path).is_file():
        raise ViewError(f"there is no file '{path}'")
    reader = pyvista.ExodusIIReader(path)
    reader.reader.SetApplyDisplacements(False)
    reader.enable_displacements = False
    times = reader.time_values
    if step > len(times):
        raise ViewError(f"'{path}' has {len(times)} time steps; --step {step} is not one of them")
    if times:
        reader.set_active_time_value(times[step - 1])
    parts = reader.read()["Element Blocks"]
    blocks = {name: part for name, part in zip(parts.keys(), parts) if part is not None and part.n_cells}
    if not blocks:
        raise ViewError(f"'{path}' holds no element block that VTK can read")
    return blocks


def vector(grid, name):
    """Nodal vector [nodes x 3] from NAME_x, NAME_y, NAME_z, which VTK joins to one array NAME_; None if absent."""
    for candidate in (name + "_", name):
        if candidate in grid.point_data:
            return np.asarray(grid.point_data[candidate])
    parts = [name + "_" + axis for axis in "xyz"]
    if all(p in grid.point_data for p in parts):
        return np.stack([grid.point_data[p] for p in parts], axis=1)
    return None


def field_values(grid, name):
    """(values, association) of a field of the grid; None where it is not there."""
    for data, association in ((grid.cell_data, "cell"), (grid.point_data, "point")):
        if name in data and np.asarray(data[name]).ndim == 1:
            return np.asarray(data[name]), association
    whole = vector(grid, name)
    if whole is not None:
        return np.linalg.norm(whole, axis=1), "point"
    axis = "xyz".find(name[-1])
    part = vector(grid, name[:-2]) if name[-2:-1] == "_" and axis >= 0 else None
    return None if part is None else (part[:, axis], "point")


def set_field(blocks, name):
    """Adds the field as "shown" to every block; the blocks without it get NaN."""
    found = {key: field_values(grid, name) for key, grid in blocks.items()}
    if all(f is None for f in found.values()):
        known = sorted({n.rstrip("_") for g in blocks.values() for n in [*g.point_data, *g.cell_data]})
        raise ViewError(f"no block has the field '{name}'; the file has: {', '.join(known) or 'no fields (is it a mesh only?)'}")
    for key, grid in blocks.items():
        values, association = found[key] or (np.full(grid.n_points, np.nan), "point")
        (grid.point_data if association == "point" else grid.cell_data)["shown"] = values


def size_of(blocks):
    points = np.vstack([g.points for g in blocks.values()])
    return float(np.linalg.norm(points.max(axis=0) - points.min(axis=0)))


def chosen_scale(text, blocks):
    if text != "auto":
        try:
            return float(text)
        except ValueError:
            raise ViewError(f"--scale must be a number or auto, not '{text}'") from None
    lengths = [np.linalg.norm(u, axis=1).max() for u in (vector(g, "displacement") for g in blocks.values()) if u is not None]
    largest = max(lengths, default=0.0)
    return 0.03 * size_of(blocks) / largest if largest > 0 else 1.0


def deform(grid, scale):
    u = vector(grid, "displacement")
    if u is not None:
        grid.points = grid.points + scale * u


def contact_faces(grid):
    """The outer faces of a body whose nodes all lie on a contact surface; None if it has none."""
    if "contact_status" not in grid.point_data:
        return None
    skin = grid.extract_surface(algorithm="dataset_surface")
    status = np.asarray(skin.point_data["contact_status"])
    faces = skin.regular_faces if skin.is_all_triangles else None
    cells = faces if faces is not None else [skin.get_cell(i).point_ids for i in range(skin.n_cells)]
    on_surface = np.array([bool(np.all(status[ids] > 0.5)) for ids in cells], dtype=bool)
    return skin.extract_cells(np.flatnonzero(on_surface)) if on_surface.any() else None


def laid_flat(blocks):
    """[(name, patch)]: every connected contact surface, seen from outside its body, one above the other in the x-y plane."""
    patches, height = [], 0.0
    for key, grid in blocks.items():
        faces = contact_faces(grid)
        for number, patch in enumerate([] if faces is None else faces.split_bodies(), start=1):
            flat = patch.extract_surface(algorithm="dataset_surface")
            normal = flat.compute_normals(auto_orient_normals=False, consistent_normals=False).cell_data["Normals"].mean(axis=0)
            arm = flat.points - flat.points.mean(axis=0)
            along = np.linalg.svd(arm - np.outer(arm @ normal, normal), full_matrices=False)[2][0]
            up = np.cross(normal, along)
            sign = 1 if up[np.argmax(np.abs(up))] > 0 else -1     # the main global axis upwards, as one would look at it
            plane = sign * np.stack([arm @ along, arm @ up], axis=1)
            height -= 1.15 * np.ptp(plane[:, 1])
            flat.points = np.column_stack([plane[:, 0], plane[:, 1] - plane[:, 1].min() + height, np.zeros(len(plane))])
            height -= 0.12 * np.ptp(plane[:, 0])
            patches.append((f"{key} ({number})", flat))
    return patches


def draw_bodies(plotter, blocks, field, edges):
    values = np.concatenate([np.asarray(g["shown"]) for g in blocks.values()]) if field != "none" else np.array([])
    for i, grid in enumerate(blocks.values()):
        skin = grid.extract_surface(algorithm="dataset_surface")
        if field == "none":
            plotter.add_mesh(skin, color=BLOCK_COLOURS[i % len(BLOCK_COLOURS)], show_edges=edges, line_width=0.5, ambient=0.3)
        else:
            plotter.add_mesh(skin, scalars="shown", cmap="turbo", ambient=0.35, diffuse=0.7, show_edges=edges, line_width=0.5,
                             nan_color="#dddddd", clim=[np.nanmin(values), np.nanpercentile(values, 99.8)],
                             scalar_bar_args={"title": field + "\n", "vertical": False, "fmt": "%.3g",
                                              "position_x": 0.2, "position_y": 0.02, "width": 0.6, "height": 0.07,
                                              "title_font_size": 16, "label_font_size": 14})


def draw_contact(plotter, patches):
    for name, patch in patches:
        status = np.asarray(patch.point_data["contact_status"])
        nodes = pyvista.PolyData(np.asarray(patch.points))
        plotter.add_mesh(patch, color="#f7f7f7", show_edges=True, edge_color="#999999", line_width=0.5, lighting=False)
        for value, colour in zip(STATUS_NAMES, STATUS_COLOURS):
            here = np.flatnonzero(np.abs(status - value) < 0.5)
            if len(here):
                plotter.add_mesh(nodes.extract_points(here), color=colour, point_size=11, render_points_as_spheres=True, lighting=False)
        corner = patch.points.min(axis=0) + np.array([0, 1.15 * np.ptp(patch.points[:, 1]), 0])
        plotter.add_point_labels([corner], [name], font_size=13, text_color="black", shape=None, show_points=False, always_visible=True)
    plotter.add_legend([[name, colour] for name, colour in zip(STATUS_NAMES.values(), STATUS_COLOURS)],
                       bcolor=None, face="circle", size=(0.13, 0.09), loc="lower right")
    plotter.add_text("contact surfaces, laid flat, seen from outside their body", font_size=10, color="black")
    plotter.view_xy()
    plotter.enable_parallel_projection()
    plotter.camera.zoom(1.1)


def aim(plotter, view):
    plotter.view_vector(CAMERA[view], viewup=(0, 0, 1) if view in ("x", "-x", "y", "-y") else (0, 1, 0))
    plotter.enable_parallel_projection()
    plotter.camera.zoom(0.84)


def require_picture(path):
    """Before anything is drawn, which takes seconds."""
    if path.suffix.lower() != ".png":
        raise ViewError(f"--output must end in .png, not '{path}'")
    if not path.parent.is_dir():
        raise ViewError(f"there is no folder '{path.parent}' for --output")


def draw(options):
    require_picture(pathlib.Path(options.output))
    blocks = read_blocks(options.input, options.step)
    for name in options.block:
        if name not in blocks:
            raise ViewError(f"no element block is named '{name}'; there are: {', '.join(blocks)}")
    blocks = {key: grid for key, grid in blocks.items() if not options.block or key in options.block}
    if options.field != "none":
        set_field(blocks, options.field)
    patches = [] if options.no_contact else laid_flat(blocks)
    scale = chosen_scale(options.scale, blocks)
    for grid in blocks.values():
        deform(grid, scale)
    plotter = pyvista.Plotter(off_screen=True, shape=(1, 2 if patches else 1), border=False,
                              window_size=(1700 if patches else 1000, 850))
    plotter.set_background("white")
    pyvista.global_theme.font.color = "black"
    draw_bodies(plotter, blocks, options.field, options.edges)
    plotter.add_text(f"{pathlib.Path(options.input).name}, displacement x {scale:.3g}", font_size=10, color="black")
    aim(plotter, options.view)
    if patches:
        plotter.subplot(0, 1)
        draw_contact(plotter, patches)
    plotter.screenshot(options.output)
    plotter.close()


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Saves a picture of a haptos result: deformed bodies and contact states.")
    parser.add_argument("input", help="result file (.exo)")
    parser.add_argument("--field", default="von_mises", help="field to colour by (default von_mises); none: by block")
    parser.add_argument("--scale", default="auto", help="magnification of the displacement (default auto)")
    parser.add_argument("--block", action="append", default=[], help="show only this element block; may be repeated")
    parser.add_argument("--step", type=int, default=0, help="time step, from 1 (default: the last)")
    parser.add_argument("--view", default="isometric", choices=sorted(CAMERA), help="direction to look from")
    parser.add_argument("--no-contact", action="store_true", help="leave the contact surface out")
    parser.add_argument("--edges", action="store_true", help="draw the edges of the elements")
    parser.add_argument("--output", default="picture.png", help="PNG file to write (default picture.png)")
    options = parser.parse_args(arguments)
    try:
        draw(options)
    except ViewError as error:
        print(f"haptos_view: {error}", file=sys.stderr)
        return 1
    print(options.output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
