#!/usr/bin/env python3
"""Writes the Pioneer 2-DX, its lasers and the Pioneers that carry them to models/, from the numbers below. Run it after changing one of them.

Lengths in m, masses in kg, angles in rad unless a name says degrees. The laser of a robot is a model of its own, merged into the robot's links, so that
its iface is called <robot>::laser.
"""
import math

from sdf_text import box, box_moments, cylinder, cylinder_moments, number, part, sphere, sphere_moments, write_model

# Pioneer 2-DX: 0.44 x 0.33 x 0.22 m, 9 kg in all. The origin is on the floor between the driven wheels, so that it is what odometry is about.
chassis_mass, wheel_mass, caster_mass = 6.6, 0.9, 0.6
body, body_x, body_z = (0.44, 0.26, 0.12), -0.045, 0.125  # between the wheels
top, top_z = (0.40, 0.33, 0.02), 0.22
wheel_radius, wheel_width, separation = 0.0825, 0.05, 0.33
caster_radius, caster_x = 0.04, -0.2
# Where the sonars sit (x, y in mm, heading in degrees); the other half is mirrored in y.
front = [(69, 136, 90), (114, 119, 50), (148, 78, 30), (166, 27, 10)]
rear = [(-157, -136, -90), (-203, -119, -130), (-237, -78, -150), (-255, -27, -170)]
sonar_z = 0.1975  # in the gap between body and top


def inertial(mass, moments, pose=None):
    place = f"<pose>{pose}</pose>" if pose else ""
    xx, yy, zz = (number(m) for m in moments)
    return f"<inertial>{place}<mass>{number(mass)}</mass><inertia><ixx>{xx}</ixx><iyy>{yy}</iyy><izz>{zz}</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>"


def material(r, g, b, shine=0.1):
    return f"<material><ambient>{r} {g} {b} 1</ambient><diffuse>{r} {g} {b} 1</diffuse><specular>{shine} {shine} {shine} 1</specular></material>"


def visual(name, geometry, colour, pose=None):
    return part("visual", name, geometry, pose, material(*colour))


def collision(name, geometry, pose=None, surface=""):
    return part("collision", name, geometry, pose, surface)


def friction(mu):
    return f"<surface><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface>"


def write(name, title, description, content):
    write_model("make_models.py", name, title, description, content.strip("\n"))


def sonar_ring():
    places = front + [(x, -y, -a) for x, y, a in reversed(front)]
    places += rear + [(x, -y, -a) for x, y, a in reversed(rear)]
    # A cone of 15 degrees that reaches 5 m.
    radius = 5 * math.tan(math.radians(7.5))
    return "\n".join(
        f'      <sensor name="sonar_{i}" type="sonar"><pose>{number(x / 1000)} {number(y / 1000)} {sonar_z} 0 0 {number(math.radians(a))}</pose>'
        f"<update_rate>10</update_rate><sonar><min>0</min><max>5</max><radius>{number(radius)}</radius></sonar></sensor>"
        for i, (x, y, a) in enumerate(places))


def wheel(side, y):
    spin = f"0 0 0 {number(-math.pi / 2)} 0 0"
    hub = f"0 {number(math.copysign(wheel_width / 2 + 0.002, y))} 0 {number(-math.pi / 2)} 0 0"
    return f"""
    <link name="{side}_wheel">
      <pose>0 {number(y)} {wheel_radius} 0 0 0</pose>
      {inertial(wheel_mass, cylinder_moments(wheel_mass, wheel_radius, wheel_width), spin)}
      <!-- A sphere touches the floor in one point and rolls round corners without scrubbing. -->
      {collision("collision", sphere(wheel_radius), None, friction(1))}
      {visual("tyre", cylinder(wheel_radius, wheel_width), (0.08, 0.08, 0.08), spin)}
      {visual("hub", cylinder(wheel_radius * 0.55, 0.01), (0.75, 0.75, 0.75), hub)}
    </link>
    <joint name="{side}_wheel_joint" type="revolute">
      <parent>chassis</parent>
      <child>{side}_wheel</child>
      <axis><xyz>0 1 0</xyz><limit><lower>-1e16</lower><upper>1e16</upper></limit></axis>
    </joint>""".strip("\n")


def pioneer():
    whole, plate = f"{body_x} 0 {body_z} 0 0 0", f"{body_x} 0 {top_z} 0 0 0"
    return f"""
  <model name="pioneer2dx">
    <link name="chassis">
      {inertial(chassis_mass, box_moments(chassis_mass, body[0], top[1], 0.2), whole)}
      {collision("body", box(*body), whole)}
      {collision("top", box(*top), plate)}
      {visual("body", box(*body), (0.72, 0.08, 0.07), whole)}
      {visual("top", box(*top), (0.86, 0.12, 0.08), plate)}
      {visual("arrow", box(0.16, 0.05, 0.004), (0.95, 0.95, 0.92), f"{body_x} 0 {top_z + top[2] / 2 + 0.001} 0 0 0")}
      {visual("front_sonars", box(0.05, 0.24, 0.025), (0.12, 0.12, 0.13), f"0.125 0 {sonar_z} 0 0 0")}
      {visual("rear_sonars", box(0.05, 0.24, 0.025), (0.12, 0.12, 0.13), f"-0.215 0 {sonar_z} 0 0 0")}
      {visual("nose", box(0.02, 0.12, 0.03), (0.9, 0.85, 0.2), f"0.18 0 {body_z} 0 0 0")}
{sonar_ring()}
    </link>
{wheel("left", separation / 2)}
{wheel("right", -separation / 2)}
    <!-- The caster carries weight and nothing else. -->
    <link name="caster">
      <pose>{caster_x} 0 {caster_radius} 0 0 0</pose>
      {inertial(caster_mass, sphere_moments(caster_mass, caster_radius))}
      {collision("collision", sphere(caster_radius), None, friction(0))}
      {visual("visual", sphere(caster_radius), (0.15, 0.15, 0.15))}
    </link>
    <joint name="caster_joint" type="fixed">
      <parent>chassis</parent>
      <child>caster</child>
    </joint>
    <!-- Parameters in the spellings of gz-sim and of Gazebo classic. Its iface is called position2d, since the name is that of a class. -->
    <plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system">
      <left_joint>left_wheel_joint</left_joint>
      <right_joint>right_wheel_joint</right_joint>
      <leftJoint>left_wheel_joint</leftJoint>
      <rightJoint>right_wheel_joint</rightJoint>
      <wheel_separation>{number(separation)}</wheel_separation>
      <wheelSeparation>{number(separation)}</wheelSeparation>
      <wheel_radius>{number(wheel_radius)}</wheel_radius>
      <wheel_diameter>{number(2 * wheel_radius)}</wheel_diameter>
      <wheelDiameter>{number(2 * wheel_radius)}</wheelDiameter>
      <torque>5</torque>
      <max_linear_velocity>0.5</max_linear_velocity>
      <min_linear_velocity>-0.5</min_linear_velocity>
      <max_linear_acceleration>1</max_linear_acceleration>
      <min_linear_acceleration>-1</min_linear_acceleration>
      <max_angular_velocity>{number(math.radians(90))}</max_angular_velocity>
      <min_angular_velocity>{number(-math.radians(90))}</min_angular_velocity>
      <max_angular_acceleration>{number(math.radians(300))}</max_angular_acceleration>
      <min_angular_acceleration>{number(-math.radians(300))}</min_angular_acceleration>
      <odom_publish_frequency>50</odom_publish_frequency>
      <updateRate>50</updateRate>
    </plugin>
  </model>"""


def ray(samples, first, last, smallest, largest, resolution, rate, sigma, pose):
    return f"""      <sensor name="laser" type="gpu_lidar">
        <pose>{pose}</pose>
        <update_rate>{rate}</update_rate>
        <visualize>true</visualize>
        <lidar>
          <scan><horizontal><samples>{samples}</samples><resolution>1</resolution><min_angle>{number(first)}</min_angle><max_angle>{number(last)}</max_angle></horizontal></scan>
          <range><min>{smallest}</min><max>{largest}</max><resolution>{resolution}</resolution></range>
          <noise><type>gaussian</type><mean>0</mean><stddev>{sigma}</stddev></noise>
        </lidar>
      </sensor>"""


def laser(name, size, mass, foot, colour, head, sensor):
    """A scanner that stands on its origin: a foot, a round head and a joint-less link; it is fixed by whoever includes it."""
    head_radius, head_height = head
    foot_z = foot / 2
    return f"""
  <model name="{name}">
    <link name="laser_link">
      {inertial(mass, box_moments(mass, *size), f"0 0 {number(size[2] / 2)} 0 0 0")}
      <!-- Lower than the beams, which would else end in it. -->
      {collision("laser_body", box(size[0], size[1], foot), f"0 0 {number(foot_z)} 0 0 0")}
      {visual("foot", box(size[0], size[1], foot), colour, f"0 0 {number(foot_z)} 0 0 0")}
      {visual("head", cylinder(head_radius, head_height), (0.08, 0.08, 0.09), f"0 0 {number(foot + head_height / 2)} 0 0 0")}
{sensor}
    </link>
  </model>"""


write("pioneer2dx", "Pioneer 2-DX", "Differential drive, frictionless caster, ring of 16 sonars. Limits 0.5 m/s, 1 m/s2, 90 deg/s.", pioneer())

# 682 of 1024 steps a turn, step 384 is the front.
step = 2 * math.pi / 1024
write("hokuyo_urg04lx", "Hokuyo URG-04LX", "Laser range finder: 682 beams over 240 degrees, 0.02 to 5.6 m, 10 Hz.",
      laser("hokuyo_urg04lx", (0.05, 0.05, 0.07), 0.16, 0.04, (0.15, 0.15, 0.17), (0.018, 0.03),
            ray(682, (44 - 384) * step, (725 - 384) * step, 0.02, 5.6, 0.001, 10, 0.01, "0 0 0.055 0 0 0")))


# Their feet are lower than the lowest beams at the edges.
def rings(columns, layers, tilt, smallest, largest, resolution, rate, sigma, pose):
    """Columns all around, counter-clockwise from the back; layers from `-tilt` to `tilt` degrees. An instant for the whole scan, unless <rolling> says otherwise."""
    step = 2 * math.pi / columns
    return f"""      <sensor name="lidar" type="gpu_lidar">
        <pose>{pose}</pose>
        <update_rate>{rate}</update_rate>
        <lidar>
          <scan>
            <horizontal><samples>{columns}</samples><resolution>1</resolution><min_angle>{number(-math.pi)}</min_angle><max_angle>{number(math.pi - step)}</max_angle></horizontal>
            <vertical><samples>{layers}</samples><resolution>1</resolution><min_angle>{number(-math.radians(tilt))}</min_angle><max_angle>{number(math.radians(tilt))}</max_angle></vertical>
          </scan>
          <range><min>{smallest}</min><max>{largest}</max><resolution>{resolution}</resolution></range>
          <noise><type>gaussian</type><mean>0</mean><stddev>{sigma}</stddev></noise>
        </lidar>
      </sensor>"""


write("velodyne_vlp16", "Velodyne VLP-16", "3D laser scanner: 16 layers over 30 degrees, 1800 columns, 0.9 to 130 m, 10 Hz, 8 mm of noise.",
      laser("velodyne_vlp16", (0.1, 0.1, 0.072), 0.83, 0.012, (0.12, 0.12, 0.14), (0.05, 0.06), rings(1800, 16, 15, 0.9, 130, 0.002, 10, 0.008, "0 0 0.0377 0 0 0")))
write("ouster_os1_64", "Ouster OS1-64", "3D laser scanner: 64 layers over 45 degrees, 1024 columns, 0.5 to 120 m, 10 Hz, 10 mm of noise.",
      laser("ouster_os1_64", (0.085, 0.085, 0.072), 0.45, 0.012, (0.2, 0.2, 0.22), (0.042, 0.06), rings(1024, 64, 22.5, 0.5, 120, 0.001, 10, 0.01, "0 0 0.038 0 0 0")))
write("sick_lms200", "SICK LMS200", "Laser range finder: 181 beams over 180 degrees, up to 8.192 m at 1 mm, 10 Hz.",
      laser("sick_lms200", (0.156, 0.155, 0.21), 4.5, 0.1, (0.1, 0.2, 0.55), (0.07, 0.11),
            ray(181, -math.pi / 2, math.pi / 2, 0.08, 8.192, 0.001, 10, 0.005, "0 0 0.13 0 0 0")))


def with_laser(name, model, place, title):
    write(name, title, f"Pioneer 2-DX that carries a {model}. Ifaces: {name}::position2d, {name}::laser, {name}::sonar.", f"""
  <model name="{name}">
    <include merge="true">
      <uri>model://pioneer2dx</uri>
    </include>
    <include merge="true">
      <uri>model://{model}</uri>
      <pose relative_to="chassis">{place}</pose>
    </include>
    <joint name="laser_joint" type="fixed">
      <parent>chassis</parent>
      <child>laser_link</child>
    </joint>
  </model>""")


deck = number(top_z + top[2] / 2)
with_laser("pioneer2dx_hokuyo", "hokuyo_urg04lx", f"0.11 0 {deck} 0 0 0", "Pioneer 2-DX with a Hokuyo URG-04LX")
with_laser("pioneer2dx_sick", "sick_lms200", f"0 0 {deck} 0 0 0", "Pioneer 2-DX with a SICK LMS200")
