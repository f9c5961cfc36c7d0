// The page shows and takes angles in degrees; the protocol, ports and ifaces have radians. A member is an angle by its name.
export const in_degrees = (radians: number): number => (radians * 180) / Math.PI;
export const in_radians = (degrees: number): number => (degrees * Math.PI) / 180;

const angle = /(^|[._])(heading|yaw|roll|pitch|pan|tilt|fov|hfov|(min|max|view|steering)?_?angle|angle_(min|max|step|increment)|angular_?res(olution)?|horizontal_fov)(\[\d+\])?$|(^|\.)orientation\.[rpy]$/i;
const turning = /(^|\.)(va|avx|avy|avz)$|(^|[._])(angular_velocity|gyro|turn_rate)([.[].*)?$/i;

// Of ifaces, which have arrays: [x, y, yaw] and twists.
const in_array: { [type: string]: [RegExp, RegExp] } = {
  position2d: [/^position\[2\]$/, /^(velocity|command)\[2\]$/], position3d: [/^$/, /^(velocity|command)\[[345]\]$/], truth: [/^$/, /^velocity\[[345]\]$/],
};

// Of joints; a target may be a torque.
const joint_angle = /^joints\[(\d+)\]\.(?:(position|lower|upper|rest)|velocity|max_velocity)$/;

// '°', '°/s', or nothing for what is no angle. `type`: of the iface, if it is one; of joints with a letter for each: t turns, s slides.
export function angle_unit(member: string, type = ''): '' | '°' | '°/s' {
  const kinds = type.startsWith('joints') && joint_angle.exec(member);
  if (kinds) return type.split(' ')[1]?.[Number(kinds[1])] === 't' ? (kinds[2] ? '°' : '°/s') : '';
  const [angles, rates] = in_array[type] ?? [];
  return turning.test(member) || rates?.test(member) ? '°/s' : angle.test(member) || angles?.test(member) ? '°' : '';
}

// As the page shows it.
export const shown_value = (member: string, value: unknown, type = ''): unknown => (typeof value === 'number' && angle_unit(member, type) ? in_degrees(value) : value);
