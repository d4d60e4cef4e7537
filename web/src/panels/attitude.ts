/** How the body is turned at the start: the first field points up, the second to the right as far as it can. */

import { Matrix4, Quaternion, Vector3 } from "three";

/** Of the second field: to the right, as the view begins. */
const AZIMUTH = 0.35;
const FRONT = new Vector3(Math.cos(AZIMUTH), Math.sin(AZIMUTH), 0);

/** Unit quaternion, real part first, that turns vectors of the body into vectors of space. */
export function attitudeOf(start: readonly number[]): number[] {
  const [alpha, beta] = [3, 6].map((k) => new Vector3(start[k], start[k + 1], start[k + 2]));
  const up = alpha.length() > 0 ? alpha : beta.length() > 0 ? beta : new Vector3(0, 0, 1);
  const body = basis(up, beta);
  const space = basis(new Vector3(0, 0, 1), FRONT);
  const q = new Quaternion().setFromRotationMatrix(space.multiply(body.transpose()));
  return [q.w, q.x, q.y, q.z];
}

/** An orthonormal basis with its third vector along `up`, the first near `front`. */
function basis(up: Vector3, front: Vector3): Matrix4 {
  const z = up.clone().normalize();
  const choices = [front, new Vector3(1, 0, 0), new Vector3(0, 1, 0)];
  const x = choices.map((one) => one.clone().addScaledVector(z, -one.dot(z))).find((one) => one.length() > 1e-6) as Vector3;
  x.normalize();
  return new Matrix4().makeBasis(x, new Vector3().crossVectors(z, x), z);
}
