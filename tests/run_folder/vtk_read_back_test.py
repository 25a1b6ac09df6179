#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Reads exported VTP files back with VTK: every array against the CSV export, placed meshes against the OBJ export, and a picture.

usage: vtk_read_back_test.py FLOTILLA [PICTURE.png]
Needs the Debian packages python3-vtk9 and, where there is no display, xvfb (scope `export` of scripts/packages.txt).
Exit code: 0 as expected, 1 not, 77 skipped: a package is not installed.
"""
import csv
import os
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml

BODIES, STEPS = 14, 60


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


try:
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError:
    skip("no VTK for /usr/bin/python3 (Debian package python3-vtk9)")


def check(condition, message):
    if not condition:
        sys.exit("FAILED: " + message)


def export_run(flotilla, folder):
    """Runs boats into a bowl and exports the run; returns the rows of the CSV by frame."""
    def call(*arguments):
        return subprocess.run([flotilla, *arguments], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout

    scene, run = folder + "/boats.json", folder + "/run"
    with open(scene, "w", encoding="utf-8") as file:
        file.write(call("scene", "boats-in-bowl", "--bodies", str(BODIES), "--seed", "1"))
    call("run", scene, "--steps", str(STEPS), "--output", run, "--quiet")
    call("export", run, "--format", "vtp")
    call("export", run, "--format", "obj")
    frames = {}
    for row in csv.DictReader(call("export", run).splitlines()):
        frames.setdefault(int(row["frame"]), []).append(row)
    return run, frames


def read_collection(path):
    """(time, file) of each frame of a .pvd file."""
    return [(float(e.get("timestep")), os.path.join(os.path.dirname(path), e.get("file"))) for e in xml.parse(path).iter("DataSet")]


def read_vtp(path):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(path)
    check(reader.CanReadFile(path) == 1, path + " is no VTP file to VTK")
    reader.Update()
    return reader.GetOutput()


def array(data, name):
    found = data.GetPointData().GetArray(name)
    check(found is not None, f"no array {name}")
    return vtk_to_numpy(found)


def check_frame(data, rows):
    """Every number of the CSV has 17 digits: what VTK reads must be the same doubles."""
    check(data.GetNumberOfPoints() == len(rows) == data.GetNumberOfVerts(), "one point and one vertex cell per body")
    expected = {"Points": "px py pz", "quaternion": "qw qx qy qz", "velocity": "vx vy vz", "angular_velocity": "wx wy wz"}
    for name, columns in expected.items():
        values = vtk_to_numpy(data.GetPoints().GetData()) if name == "Points" else array(data, name)
        for row, value in zip(rows, values):
            check([float(row[c]) for c in columns.split()] == list(value), f"{name} of {row['name']}: {value}")
    check(list(array(data, "body")) == list(range(len(rows))), "bodies are numbered in scene order")
    for velocity, speed in zip(array(data, "velocity"), array(data, "speed")):
        check(abs(sum(x * x for x in velocity) ** 0.5 - speed) <= 1e-14 * speed, "speed")
    for name in ("shape", "type", "contacts", "cluster", "cost"):
        check(len(array(data, name)) == len(rows), f"a {name} of each body")


def placed_by_vtk(mesh, data, body):
    """World vertices of a body as a glyph of VTK has them: turned by the quaternion, moved to the point."""
    turn = [[0.0] * 3 for _ in range(3)]
    vtk.vtkMath.QuaternionToMatrix3x3(list(array(data, "quaternion")[body]), turn)
    x, y, z = data.GetPoint(body)
    transform = vtk.vtkTransform()
    transform.SetMatrix([*turn[0], x, *turn[1], y, *turn[2], z, 0, 0, 0, 1])
    return [transform.TransformPoint(mesh.GetPoint(i)) for i in range(mesh.GetNumberOfPoints())]


def check_placement(meshes, data, obj):
    """The vertices of all bodies in the OBJ file, in order, are where the glyphs are."""
    with open(obj, encoding="utf-8") as file:
        expected = [tuple(map(float, line.split()[1:])) for line in file if line.startswith("v ")]
    placed = []
    for body in range(data.GetNumberOfPoints()):
        placed += placed_by_vtk(meshes[array(data, "shape")[body]], data, body)
    check(len(placed) == len(expected), "as many vertices as in the OBJ file")
    worst = max(abs(a - b) for p, q in zip(placed, expected) for a, b in zip(p, q))
    check(worst < 1e-12, f"a vertex is {worst} m away from the one in the OBJ file")
    return worst


def with_display():
    """Starts a virtual display where there is none; returns its process."""
    if os.environ.get("DISPLAY"):
        return None
    if not shutil.which("Xvfb"):
        skip("no display and no Xvfb (Debian package xvfb); everything but the picture is as expected")
    end, begin = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(begin), "-screen", "0", "1280x960x24"], pass_fds=[begin],
                              stderr=subprocess.DEVNULL)
    os.close(begin)
    os.environ["DISPLAY"] = ":" + os.read(end, 16).decode().strip()
    return server


def render(meshes, data, picture):
    """Glyphs coloured by speed, without the ground, which would fill the background."""
    shown = vtk.vtkBitArray()
    shown.SetName("shown")
    for shape in array(data, "shape"):
        shown.InsertNextValue(1 if meshes[shape].GetNumberOfCells() > 2 else 0)
    data.GetPointData().AddArray(shown)
    mapper = vtk.vtkGlyph3DMapper()
    mapper.SetInputData(data)
    mapper.SetMaskArray("shown")
    mapper.MaskingOn()
    for index, mesh in meshes.items():
        mapper.SetSourceData(index, mesh)
    mapper.SourceIndexingOn()
    mapper.SetSourceIndexArray("shape")
    mapper.SetOrientationArray("quaternion")
    mapper.SetOrientationModeToQuaternion()
    mapper.ScalingOff()
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray("speed")
    mapper.SetScalarRange(data.GetPointData().GetArray("speed").GetRange())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    scene = vtk.vtkRenderer()
    scene.SetBackground(1, 1, 1)
    scene.AddActor(actor)
    scene.GetActiveCamera().SetPosition(0, -9, 16)
    scene.GetActiveCamera().SetFocalPoint(0, 0, 1.5)
    scene.GetActiveCamera().SetViewUp(0, 0, 1)
    scene.ResetCameraClippingRange()
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(960, 720)
    window.AddRenderer(scene)
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(picture)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()
    pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
    colours = len({tuple(p) for p in pixels[::7]})
    share = (pixels != 255).any(axis=1).mean()
    check(colours > 20 and 0.1 < share < 0.9, f"the picture shows too little or too much: {colours} colours, {share:.0%} not background")
    return colours, share


def main(flotilla, picture=None):
    with tempfile.TemporaryDirectory() as folder:
        run, frames = export_run(flotilla, folder)
        collection = read_collection(run + "/vtp/bodies.pvd")
        check(len(collection) == len(frames) == STEPS + 1, "a file for each frame")
        for k, (time, path) in enumerate(collection):
            check(time == float(frames[k][0]["time"]), f"time of frame {k}")
            data = read_vtp(path)
            check_frame(data, frames[k])
        check(array(data, "contacts").max() > 0, "bodies in a bowl touch each other")
        names = sorted(os.listdir(run + "/vtp/meshes"))
        meshes = {int(name.split("-")[0]): read_vtp(run + "/vtp/meshes/" + name) for name in names}
        worst = check_placement(meshes, data, f"{run}/obj/frame-{STEPS:08}.obj")
        print(f"{len(frames)} frames of {len(frames[0])} bodies read back by VTK {vtk.vtkVersion().GetVTKVersion()}, bit for bit; "
              f"vertices within {worst:.2g} m of the OBJ export")
        server = with_display()
        try:
            colours, share = render(meshes, data, picture or folder + "/picture.png")
        finally:
            if server:
                server.terminate()
        print(f"picture: {colours} colours, {share:.0%} not background")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(*sys.argv[1:])
