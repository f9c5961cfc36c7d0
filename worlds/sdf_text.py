"""SDFormat texts for the scripts that write worlds and models. Lengths in m, masses in kg, angles in rad."""
import math
import pathlib

here = pathlib.Path(__file__).resolve().parent


def number(value):
    text = f"{value:g}"
    return "0" if text == "-0" else text


def numbers(values):
    return " ".join(number(value) for value in values)


def box(*size):
    return f"<geometry><box><size>{numbers(size)}</size></box></geometry>"


def cylinder(radius, length):
    return f"<geometry><cylinder><radius>{number(radius)}</radius><length>{number(length)}</length></cylinder></geometry>"


def sphere(radius):
    return f"<geometry><sphere><radius>{number(radius)}</radius></sphere></geometry>"


def paint(colour):
    return f"<material><ambient>{colour} 1</ambient><diffuse>{colour} 1</diffuse></material>"


def part(kind, name, shape, pose="", extra=""):
    """A visual or a collision."""
    place = f"<pose>{pose}</pose>" if pose else ""
    return f'<{kind} name="{name}">{place}{shape}{extra}</{kind}>'


def static(name, pose, shape, material):
    """A model of one shape that does not move."""
    return (f'    <model name="{name}"><static>true</static><pose>{pose}</pose><link name="link">'
            f'{part("collision", "collision", shape)}{part("visual", "visual", shape, "", material)}</link></model>')


def walls(half, thickness, height, material):
    """Around a square; those in the north and south cover the corners."""
    longer, shorter = 2 * half + thickness, 2 * half - thickness
    sides = [("north", 0, half, longer, thickness), ("south", 0, -half, longer, thickness), ("east", half, 0, thickness, shorter), ("west", -half, 0, thickness, shorter)]
    return [static(f"wall_{name}", f"{numbers((x, y, height / 2))} 0 0 0", box(sx, sy, height), material) for name, x, y, sx, sy in sides]


def include(model, name, pose, more=""):
    return f"    <include><uri>model://{model}</uri><name>{name}</name><pose>{pose}</pose>{more}</include>"


def scene(ambient, background, more=""):
    return f"    <scene>\n      <ambient>{ambient} 1</ambient>\n      <background>{background} 1</background>\n{more}      <shadows>true</shadows>\n    </scene>\n"


def world(command, name, lines, step=0.001, look="", ground="ground_plane"):
    """The whole text of a world with a sun and a ground."""
    content = "\n".join(lines)
    return f"""<?xml version="1.0"?>
<!-- Written by worlds/{command}. -->
<sdf version="1.9">
  <world name="{name}">
    <physics name="default" type="ode">
      <max_step_size>{step:g}</max_step_size>
      <real_time_factor>1</real_time_factor>
    </physics>
{look}    <include><uri>model://sun</uri></include>
    <include><uri>model://{ground}</uri></include>
{content}
  </world>
</sdf>
"""


def write_model(command, name, title, description, content):
    """model.sdf and model.config in models/NAME."""
    folder = here / "models" / name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.config").write_text(
        f'<?xml version="1.0"?>\n<model>\n  <name>{title}</name>\n  <version>1.0</version>\n  <sdf version="1.9">model.sdf</sdf>\n  <description>{description}</description>\n</model>\n')
    (folder / "model.sdf").write_text(f'<?xml version="1.0"?>\n<!-- Written by worlds/{command}. -->\n<sdf version="1.9">\n{content}\n</sdf>\n')


def box_moments(mass, x, y, z):
    return mass / 12 * (y * y + z * z), mass / 12 * (x * x + z * z), mass / 12 * (x * x + y * y)


def cylinder_moments(mass, radius, length):  # along z
    across = mass * (3 * radius * radius + length * length) / 12
    return across, across, mass * radius * radius / 2


def sphere_moments(mass, radius):
    return (0.4 * mass * radius * radius,) * 3
