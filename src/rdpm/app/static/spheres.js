// The spheres of a run, the box, and a slice of the flow; three.js comes with NiceGUI.
import { THREE, OrbitControls } from "nicegui-scene";

const FEW = 300; // spheres, of which each is looked at
const PALETTE = ["#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"];

function decode(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

// A sphere is one square that faces the eye; each of its pixels meets the sphere by the ray through it: two triangles,
// and round at any distance.
const VERTEX = `
in vec3 centre;
in vec4 turn;
in float radius;
in vec3 paint;
out vec3 ray;
flat out vec3 middle;
flat out vec4 about;
flat out float size;
flat out float pixels;
flat out vec3 colour;
uniform float height;

void main() {
  vec3 c = (modelViewMatrix * vec4(centre, 1.0)).xyz;
  float far = length(c);
  vec3 towards = c / far;
  vec3 right = normalize(cross(towards, abs(towards.y) < 0.9 ? vec3(0, 1, 0) : vec3(1, 0, 0)));
  vec3 up = cross(right, towards);
  float reach = radius * far / sqrt(max(far * far - radius * radius, 1e-3 * radius * radius));
  ray = c + reach * (position.x * right + position.y * up);
  middle = c;
  about = turn;
  size = radius;
  colour = paint;
  pixels = 0.5 * height * projectionMatrix[1][1] * radius / far;
  gl_Position = projectionMatrix * vec4(ray, 1.0);
}`;

// Eight sectors, light and dark by turns: a rotation is seen from anywhere.
const FRAGMENT = `
in vec3 ray;
flat in vec3 middle;
flat in vec4 about;
flat in float size;
flat in float pixels;
flat in vec3 colour;
uniform mat4 projectionMatrix;

void main() {
  vec3 to = normalize(ray);
  float nearest = dot(to, middle);
  vec3 aside = nearest * to - middle;
  float left = size * size - dot(aside, aside);
  if (left < 0.0) discard;
  float root = sqrt(left);
  vec3 normal = (aside - root * to) / size;
  vec3 place = (nearest - root) * to;
  float depth = projectionMatrix[2][2] * place.z + projectionMatrix[3][2];
  gl_FragDepth = 0.5 - 0.5 * depth / place.z;

  vec3 world = normal * mat3(viewMatrix);
  vec3 v = -about.xyz;
  vec3 own = world + 2.0 * cross(v, cross(v, world) + about.w * world);
  vec3 side = clamp(own * pixels, -1.0, 1.0);
  float light = 0.68 + 0.32 * side.x * side.y * side.z;

  float sun = max(dot(normal, vec3(-0.36, 0.6, 0.714)), 0.0);
  float gloss = sun * sun;
  gloss *= gloss;
  gloss *= gloss;
  gloss *= gloss * gloss;
  vec3 seen = colour * light * (0.34 + 0.14 * normal.y + 0.72 * sun) + 0.16 * gloss * gloss;
  gl_FragColor = vec4(seen, clamp(pixels * (1.0 - length(aside) / size), 0.0, 1.0));
  #include <colorspace_fragment>
}`;

export default {
  template: `<div class="rdpm-scene" tabindex="0" role="img" :aria-label="label">
    <canvas aria-hidden="true"></canvas><p v-if="refused" class="rdpm-note">{{ refused }}</p></div>`,
  props: { box: Array, diameters: Array, up: Number, label: String },
  data: () => ({ refused: "" }),
  mounted() {
    this.frames = 0;
    try {
      this.begin();
    } catch {
      this.refused = "This browser has no WebGL: the scene is not drawn. All curves and tables are.";
    }
  },
  beforeUnmount() {
    this.ended = true;
    this.observer?.disconnect();
    this.shade?.disconnect();
    this.controls?.dispose();
    this.renderer?.dispose();
  },
  methods: {
    begin() {
      const canvas = this.$el.querySelector("canvas");
      // Smooth edges of many small spheres cost more than they show.
      const context = canvas.getContext("webgl2", { alpha: false, antialias: this.diameters.length <= FEW });
      if (!context) throw new Error("no WebGL");
      this.renderer = new THREE.WebGLRenderer({ canvas, context });
      this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
      this.scene = new THREE.Scene();
      this.scene.background = new THREE.Color();
      const size = new THREE.Vector3(...this.box);
      const longest = Math.max(size.x, size.y, size.z);
      this.scale = 1 / longest; // lengths of about one, whatever the box
      const middle = size.clone().multiplyScalar(0.5 * this.scale);
      this.camera = new THREE.PerspectiveCamera(35, 1, 0.01, 20);
      this.camera.up.set(this.up === 0 ? 1 : 0, this.up === 1 ? 1 : 0, this.up === 2 ? 1 : 0);
      this.controls = new OrbitControls(this.camera, this.$el);
      this.controls.target.copy(middle);
      this.controls.listenToKeyEvents(this.$el);
      this.controls.keyRotateSpeed = 20;
      // Whoever scrolls the page is not caught by the scene.
      this.$el.addEventListener("wheel", (e) => e.ctrlKey || e.metaKey || e.stopImmediatePropagation(), { capture: true });
      this.$el.style.touchAction = "pan-y";
      this.$el.addEventListener("keydown", (e) => this.press(e));
      this.controls.addEventListener("change", () => this.draw());
      this.controls.addEventListener("start", () => (this.from = "")); // from now on the visitor's own
      const edges = new THREE.EdgesGeometry(new THREE.BoxGeometry(...size.clone().multiplyScalar(this.scale)));
      const box = new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: 0x888888 }));
      box.position.copy(middle);
      this.scene.add(box);
      this.spheres();
      this.look("front");
      this.observer = new ResizeObserver(() => this.fit());
      this.observer.observe(this.$el);
      this.shade = new MutationObserver(() => this.draw()); // light or dark
      this.shade.observe(document.body, { attributeFilter: ["class"] });
      this.fit();
    },
    spheres() {
      const count = this.diameters.length;
      // Four corners a sphere, all in one drawing: a software renderer takes each instance as a drawing of its own.
      const shape = new THREE.BufferGeometry();
      const each = (name, width, value) => {
        const values = Float32Array.from({ length: 4 * width * count }, (_, n) => {
          const corner = Math.floor(n / width);
          return value(corner >> 2, n % width, corner & 3);
        });
        const made = new THREE.BufferAttribute(values, width);
        shape.setAttribute(name, made);
        return made;
      };
      const paints = PALETTE.map((name) => new THREE.Color(name).toArray());
      each("position", 3, (body, axis, corner) => [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]][corner][axis]);
      each("radius", 1, (body) => 0.5 * this.diameters[body] * this.scale);
      each("paint", 3, (body, band) => paints[body % paints.length][band]);
      this.centre = each("centre", 3, () => 0);
      this.turn = each("turn", 4, () => 0);
      const corners = [0, 1, 2, 0, 2, 3];
      shape.setIndex(Array.from({ length: 6 * count }, (_, n) => 4 * Math.floor(n / 6) + corners[n % 6]));
      const paint = new THREE.ShaderMaterial({
        vertexShader: VERTEX, fragmentShader: FRAGMENT, glslVersion: null, uniforms: { height: { value: 1 } },
        alphaToCoverage: count <= FEW,
      });
      this.mesh = new THREE.Mesh(shape, paint);
      this.mesh.frustumCulled = false;
      this.mesh.visible = false;
      this.scene.add(this.mesh);
    },
    look(from) {
      if (!this.camera) return;
      this.from = from;
      const size = this.box.map((length) => length * this.scale);
      const way = { front: [0.25, -1, 0.2], corner: [1, -1, 0.7], above: [0.001, -0.05, 1] }[from];
      const turned = this.up === 2 ? way : this.up === 1 ? [way[0], way[2], -way[1]] : [way[2], way[1], way[0]];
      // As near as all corners of the box allow.
      const back = new THREE.Vector3(...turned).normalize();
      const right = new THREE.Vector3().crossVectors(this.camera.up, back).normalize();
      const top = new THREE.Vector3().crossVectors(back, right);
      const slope = 0.95 * Math.tan((Math.PI * this.camera.fov) / 360);
      let far = 0;
      for (let n = 0; n < 8; n++) {
        const corner = new THREE.Vector3(...size.map((length, axis) => (n & (1 << axis) ? 0.5 : -0.5) * length));
        const aside = Math.max(Math.abs(corner.dot(right)) / this.camera.aspect, Math.abs(corner.dot(top)));
        far = Math.max(far, aside / slope + corner.dot(back));
      }
      this.camera.position.set(...size.map((length) => length / 2)).add(back.multiplyScalar(far));
      this.controls.update();
      this.draw();
    },
    press(event) {
      const nearer = { "+": 0.85, "=": 0.85, "-": 1 / 0.85 }[event.key];
      if (!nearer || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      this.from = "";
      this.camera.position.sub(this.controls.target).multiplyScalar(nearer).add(this.controls.target);
      this.controls.update();
    },
    fit() {
      const width = Math.max(1, this.$el.clientWidth);
      const height = Math.max(1, this.$el.clientHeight);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      if (this.from) this.look(this.from);
      this.draw();
    },
    frame(position, rotation) {
      if (!this.mesh) return;
      const give = (attribute, values, width, factor) => {
        const count = Math.min(values.length, attribute.array.length / 4);
        for (let n = 0; n < count; n++) {
          const at = 4 * n - 3 * (n % width); // the first corner's
          for (let corner = 0; corner < 4; corner++) attribute.array[at + corner * width] = values[n] * factor;
        }
      };
      give(this.centre, decode(position), 3, this.scale);
      give(this.turn, decode(rotation), 4, 1);
      this.centre.needsUpdate = this.turn.needsUpdate = true;
      this.mesh.visible = true;
      this.draw();
    },
    slice(picture, normal, position) {
      if (!this.scene) return;
      new THREE.TextureLoader().load(picture, (texture) => {
        if (this.ended) return;
        texture.colorSpace = THREE.SRGBColorSpace;
        this.hide_slice();
        const [across, up] = this.axes(normal);
        const plane = new THREE.PlaneGeometry(this.box[across] * this.scale, this.box[up] * this.scale);
        const basis = new THREE.Matrix4();
        const unit = (n) => new THREE.Vector3(n === 0 ? 1 : 0, n === 1 ? 1 : 0, n === 2 ? 1 : 0);
        const right = unit(across), top = unit(up);
        basis.makeBasis(right, top, new THREE.Vector3().crossVectors(right, top));
        const paint = new THREE.MeshBasicMaterial({ map: texture, side: THREE.DoubleSide, transparent: true, opacity: 0.85 });
        this.layer = new THREE.Mesh(plane, paint);
        this.layer.setRotationFromMatrix(basis);
        const middle = this.box.map((length) => 0.5 * length * this.scale);
        middle[normal] = position * this.scale;
        this.layer.position.set(...middle);
        this.scene.add(this.layer);
        this.draw();
      });
    },
    axes(normal) {
      const others = [0, 1, 2].filter((n) => n !== normal);
      const up = others.includes(this.up) ? this.up : others[1];
      return [others.find((n) => n !== up), up];
    },
    hide_slice() {
      if (!this.layer) return;
      this.scene.remove(this.layer);
      this.layer.material.map.dispose();
      this.layer.material.dispose();
      this.layer.geometry.dispose();
      this.layer = null;
      this.draw();
    },
    // One drawing for each picture of the screen, however many frames came in between.
    draw() {
      if (this.pending || this.ended || !this.renderer) return;
      this.pending = true;
      requestAnimationFrame(() => {
        this.pending = false;
        if (this.ended) return;
        this.scene.background.setStyle(getComputedStyle(this.$el).backgroundColor);
        this.mesh.material.uniforms.height.value = this.renderer.domElement.height;
        this.renderer.render(this.scene, this.camera);
        this.frames += 1;
        this.$el.dataset.frames = this.frames;
      });
    },
  },
};
