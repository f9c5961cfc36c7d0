#!/usr/bin/env python3
"""Writes maze.sdf from the plan below: one closed corridor, 2 m wide, with turns to both sides, and two Pioneers with SICK lasers one behind the other."""
import sdf_text

cell, height, thickness = 2.0, 0.6, 0.1
plan = """
###########
#.........#
#.#######.#
#.#.....#.#
#.#.###.#.#
#...###...#
###########
""".split()
rows, columns = len(plan), len(plan[0])


def is_open(row, column):
    return 0 <= row < rows and 0 <= column < columns and plan[row][column] == "."


def place(row, column):
    """Middle of a cell; x grows with the columns, y shrinks with the rows."""
    return (column - (columns - 1) / 2) * cell, ((rows - 1) / 2 - row) * cell


walls = []  # x, y, size x, size y
for row in range(rows + 1):  # along x: between row - 1 and row
    column = 0
    while column < columns:
        begin = column
        while column < columns and is_open(row - 1, column) != is_open(row, column):
            column += 1
        if column > begin:
            x0, y = place(row, begin)
            x1, _ = place(row, column - 1)
            walls.append(((x0 + x1) / 2, y + cell / 2, x1 - x0 + cell + thickness, thickness))
        else:
            column += 1
for column in range(columns + 1):  # along y: between column - 1 and column
    row = 0
    while row < rows:
        begin = row
        while row < rows and is_open(row, column - 1) != is_open(row, column):
            row += 1
        if row > begin:
            x, y0 = place(begin, column)
            _, y1 = place(row - 1, column)
            walls.append((x - cell / 2, (y0 + y1) / 2, thickness, y0 - y1 + cell - thickness))
        else:
            row += 1


def wall(index, x, y, sx, sy):
    pose = f"{sdf_text.numbers((x, y, height / 2))} 0 0 0"
    return "\n".join(f'        {sdf_text.part(kind, f"wall_{index}", sdf_text.box(sx, sy, height), pose, extra)}'
                     for kind, extra in (("collision", ""), ("visual", sdf_text.paint("0.75 0.7 0.6"))))


def robot(name, x, y):
    return f"""    <include>
      <uri>model://pioneer2dx_sick</uri>
      <name>{name}</name>
      <pose>{sdf_text.numbers((x, y))} 0 0 0 0</pose>
    </include>"""


content = "\n".join(wall(i, *w) for i, w in enumerate(walls))
leader, follower = place(1, 3), place(1, 2)
maze = f"""    <model name="maze">
      <static>true</static>
      <link name="walls">
{content}
      </link>
    </model>"""
(sdf_text.here / "maze.sdf").write_text(
    sdf_text.world("make_maze.py", "maze", [maze, robot("leader", *leader), robot("follower", follower[0] + 0.4, follower[1])]))
