// The page shows and takes angles in degrees; the protocol has radians.
export const in_degrees = (radians: number): number => (radians * 180) / Math.PI;
export const in_radians = (degrees: number): number => (degrees * Math.PI) / 180;
