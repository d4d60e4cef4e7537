/** What every view in three dimensions is drawn on: a canvas with a camera that turns, and light. */

import { AmbientLight, DirectionalLight, HemisphereLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Ribbon } from "./ribbon";

interface What {
  /** What cannot be drawn without WebGL, and what is seen. */
  readonly name: string;
  readonly label: string;
  /** Heights of the camera and of the point at which it looks. */
  readonly eye: number;
  readonly middle: number;
}

/** Degrees that are seen, and the ratio of width and height below which a narrow page sees the same width. */
const VIEW = 32;
const NARROW = 1.15;

export abstract class Stage {
  /** Without WebGL there is a message, and everything else goes on. */
  readonly works: boolean;
  /** Whether the processor draws, without a graphics card. */
  readonly software: boolean;
  dirty = true;
  protected renderer!: WebGLRenderer;
  protected readonly scene = new Scene();
  protected readonly camera = new PerspectiveCamera(VIEW, 1, 0.1, 60);
  protected height = 0;
  private controls!: OrbitControls;

  constructor(protected readonly holder: HTMLElement, quality: "low" | "full" | null, what: What) {
    try {
      this.renderer = new WebGLRenderer({ antialias: quality !== "low", alpha: true, preserveDrawingBuffer: true });
    } catch {
      const message = document.createElement("p");
      message.className = "none";
      message.textContent = `This browser shows no WebGL, so ${what.name} cannot be drawn. All charts go on.`;
      holder.append(message);
      [this.works, this.software] = [false, false];
      return;
    }
    const { renderer, camera } = this;
    const context = renderer.getContext();
    const known = context.getExtension("WEBGL_debug_renderer_info");
    const name = String(context.getParameter(known ? known.UNMASKED_RENDERER_WEBGL : context.RENDERER));
    [this.works, this.software] = [true, quality ? quality === "low" : /swiftshader|llvmpipe|software|basic render/i.test(name)];
    renderer.setPixelRatio(this.software ? 1 : Math.min(devicePixelRatio, 2));
    renderer.domElement.setAttribute("role", "img");
    renderer.domElement.setAttribute("aria-label", `${what.label} Drag or use Shift and the arrow keys to turn the view.`);
    holder.append(renderer.domElement);
    camera.up.set(0, 0, 1);
    camera.position.set(4.9, -5.6, what.eye);
    this.controls = new OrbitControls(camera, renderer.domElement);
    Object.assign(this.controls, { enablePan: false, minDistance: 3.5, maxDistance: 16, maxPolarAngle: 1.75 });
    this.controls.target.set(0, 0, what.middle);
    this.controls.addEventListener("change", () => (this.dirty = true));
    this.controls.update();
  }

  /** Light from above, and from all around. */
  protected light(sun: DirectionalLight, around: number, everywhere: number): void {
    sun.position.set(2.2, -2.6, 6);
    this.scene.add(sun, new HemisphereLight(0xffffff, 0x8a8f9a, around), new AmbientLight(0xffffff, everywhere));
  }

  /** Lines that are as wide as so many pixels. */
  protected abstract ribbons(): readonly Ribbon[];

  /** Follows the size of its place, from when everything is there. */
  protected fits(): void {
    new ResizeObserver(() => this.resize()).observe(this.holder);
    this.resize();
  }

  /** Turns the view by angles. */
  turn(azimuth: number, polar: number): void {
    if (!this.works) return;
    const offset = this.camera.position.clone().sub(this.controls.target);
    const side = new Vector3().crossVectors(this.camera.up, offset).normalize();
    offset.applyAxisAngle(this.camera.up, azimuth).applyAxisAngle(side, polar);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.dirty = true;
  }

  protected resize(): void {
    const { clientWidth: width, clientHeight: height } = this.holder;
    if (!width || !height || !this.works) return;
    this.height = height;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.fov = VIEW * Math.max(Math.min(NARROW / (width / height), 1.6), 1);
    this.camera.updateProjectionMatrix();
    for (const ribbon of this.ribbons()) ribbon.material.uniforms.size.value.set(width, height);
    this.dirty = true;
  }

  /** Gives the context of the canvas back, of which a browser has few. */
  free(): void {
    if (!this.works) return;
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}
