#!/usr/bin/env python3
"""Writes maze.sdf from the plan below: one closed corridor, 2 m wide, with turns to both sides, and two Pioneers with SICK lasers one behind the other."""
import pathlib

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
    pose = f"<pose>{x:g} {y:g} {height / 2:g} 0 0 0</pose>"
    shape = f"<geometry><box><size>{sx:g} {sy:g} {height:g}</size></box></geometry>"
    colour = "<material><ambient>0.75 0.7 0.6 1</ambient><diffuse>0.75 0.7 0.6 1</diffuse></material>"
    return f'        <collision name="wall_{index}">{pose}{shape}</collision>\n        <visual name="wall_{index}">{pose}{shape}{colour}</visual>'


content = "\n".join(wall(i, *w) for i, w in enumerate(walls))
leader, follower = place(1, 3), place(1, 2)
pathlib.Path(__file__).resolve().with_name("maze.sdf").write_text(f"""<?xml version="1.0"?>
<!-- Written by worlds/make_maze.py. -->
<sdf version="1.9">
  <world name="maze">
    <physics name="default" type="ode">
      <max_step_size>0.001</max_step_size>
      <real_time_factor>1</real_time_factor>
    </physics>
    <include><uri>model://sun</uri></include>
    <include><uri>model://ground_plane</uri></include>
    <model name="maze">
      <static>true</static>
      <link name="walls">
{content}
      </link>
    </model>
    <include>
      <uri>model://pioneer2dx_sick</uri>
      <name>leader</name>
      <pose>{leader[0]:g} {leader[1]:g} 0 0 0 0</pose>
    </include>
    <include>
      <uri>model://pioneer2dx_sick</uri>
      <name>follower</name>
      <pose>{follower[0] + 0.4:g} {follower[1]:g} 0 0 0 0</pose>
    </include>
  </world>
</sdf>
""")
