/**
 * Angular momenta, seen from the body: the ellipsoid of those that have the present kinetic energy, the sphere of those that
 * are as long as the present one, and the curve in which the two meet.  Of a body that no field turns both stand still, and
 * the curve is the polhode.
 */

import { Color, FrontSide, Group, Mesh, MeshBasicMaterial, MeshStandardMaterial, SphereGeometry, Vector3 } from "three";
import type { Results } from "../results";
import type { Palette } from "../style/palette";
import { rod } from "./parts";

/** The longest of all lengths, in units of the scene. */
const LONGEST = 1.55;
/** Half of the width of the curve, in pixels. */
const CURVE = 1.6;

export class MomentumView extends Group {
  private readonly ellipsoid: Mesh;
  private readonly sphere: Mesh;
  private readonly axes = new Group();
  private readonly curve = { length: { value: 1 }, axes: { value: new Vector3(1, 1, 1) }, line: { value: new Color() } };
  private scaledFor: Results | null = null;
  private factor = 1;

  constructor(simple: boolean) {
    super();
    this.ellipsoid = new Mesh(new SphereGeometry(1, simple ? 64 : 128, simple ? 48 : 96), this.surface());
    this.sphere = new Mesh(new SphereGeometry(1, 64, 48), new MeshBasicMaterial({ transparent: true, depthWrite: false, side: FrontSide }));
    this.sphere.renderOrder = 3;
    this.ellipsoid.renderOrder = 1;
    this.add(this.ellipsoid, this.sphere, this.axes);
  }

  /** The curve is drawn where a point of the ellipsoid is as far from the centre as the angular momentum is long. */
  private surface(): MeshStandardMaterial {
    const material = new MeshStandardMaterial({ roughness: 0.42, metalness: 0.05, transparent: true, opacity: 0.6, depthWrite: false });
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, { curveLength: this.curve.length, curveAxes: this.curve.axes, curveColour: this.curve.line });
      shader.vertexShader = `uniform vec3 curveAxes;\nvarying vec3 vMomentum;\n${shader.vertexShader}`.replace(
        "#include <begin_vertex>",
        "#include <begin_vertex>\nvMomentum = position * curveAxes;",
      );
      shader.fragmentShader = `uniform float curveLength;\nuniform vec3 curveColour;\nvarying vec3 vMomentum;\n${shader.fragmentShader}`.replace(
        "#include <opaque_fragment>",
        `float away = length(vMomentum) - curveLength;
        float near = 1.0 - smoothstep(${CURVE.toFixed(1)} - 0.7, ${CURVE.toFixed(1)} + 0.7, abs(away) / max(fwidth(away), 1e-6));
        outgoingLight = mix(outgoingLight, curveColour, near);
        diffuseColor.a = max(diffuseColor.a, near);
        #include <opaque_fragment>`,
      );
    };
    return material;
  }

  paint(palette: Palette): void {
    const shell = this.ellipsoid.material as MeshStandardMaterial;
    shell.color.set(palette.body);
    this.curve.line.value.set(palette.a);
    (this.sphere.material as MeshBasicMaterial).color.set(palette.l);
    (this.sphere.material as MeshBasicMaterial).opacity = palette.dark ? 0.13 : 0.16;
    const steel = new MeshStandardMaterial({ color: palette.axis, roughness: 0.4, metalness: 0.4 });
    this.axes.clear();
    for (const k of [0, 1, 2]) {
      const end = new Vector3().setComponent(k, LONGEST + 0.22);
      this.axes.add(rod(end.clone().negate(), end, 0.011, steel));
    }
  }

  /** Where the axes end, for their names. */
  ends(): Vector3[] {
    return [0, 1, 2].map((k) => new Vector3().setComponent(k, LONGEST + 0.22));
  }

  /** One scale for an orbit: what is longest in its first 60 time units fits. */
  fitted(results: Results): number {
    if (this.scaledFor === results) return this.factor;
    const most = results.top.largestOfEllipsoid(60);
    if (most > 0) this.factor = LONGEST / Math.sqrt(most);
    if (results.top.end >= 35 || results.finished) this.scaledFor = results;
    return this.factor;
  }

  move(squares: Float64Array, results: Results): void {
    const [x, y, z, length] = [...squares].map((square) => Math.sqrt(Math.max(square, 0)) * this.fitted(results));
    // an ellipsoid that shrinks to a point still has a place
    this.curve.axes.value.set(x, y, z).max(new Vector3(1e-4, 1e-4, 1e-4));
    this.ellipsoid.scale.copy(this.curve.axes.value);
    this.sphere.scale.setScalar(Math.max(length, 1e-4));
    this.curve.length.value = length;
  }
}
