// The spheres of a run as one instanced mesh, the box, and a slice of the flow; three.js comes with NiceGUI.
import { THREE, OrbitControls } from "nicegui-scene";

const PALETTE = ["#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"];

function decode(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

// Stripes along the meridians, two light and two dark: a rotation is seen from anywhere.
function stripes() {
  const canvas = document.createElement("canvas");
  canvas.width = 64;
  canvas.height = 32;
  const pen = canvas.getContext("2d");
  pen.fillStyle = "#ffffff";
  pen.fillRect(0, 0, 64, 32);
  pen.fillStyle = "#7d7d7d";
  pen.fillRect(0, 0, 16, 16);
  pen.fillRect(32, 0, 16, 16);
  pen.fillRect(16, 16, 16, 16);
  pen.fillRect(48, 16, 16, 16);
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  return texture;
}

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
    this.renderer?.dispose();
  },
  methods: {
    begin() {
      const canvas = this.$el.querySelector("canvas");
      if (!canvas.getContext("webgl2")) throw new Error("no WebGL");
      this.renderer = new THREE.WebGLRenderer({ canvas, context: canvas.getContext("webgl2"), alpha: true });
      this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
      this.scene = new THREE.Scene();
      const size = new THREE.Vector3(...this.box);
      const longest = Math.max(size.x, size.y, size.z);
      this.scale = 1 / longest; // lengths of about one, whatever the box
      const middle = size.clone().multiplyScalar(0.5 * this.scale);
      this.camera = new THREE.PerspectiveCamera(35, 1, 0.01, 20);
      this.camera.up.set(this.up === 0 ? 1 : 0, this.up === 1 ? 1 : 0, this.up === 2 ? 1 : 0);
      this.controls = new OrbitControls(this.camera, this.$el);
      this.controls.target.copy(middle);
      this.controls.listenToKeyEvents(this.$el);
      this.controls.addEventListener("change", () => this.draw());
      this.controls.addEventListener("start", () => (this.from = "")); // from now on the visitor's own
      this.scene.add(new THREE.HemisphereLight(0xffffff, 0x888888, 2.2));
      const sun = new THREE.DirectionalLight(0xffffff, 1.8);
      sun.position.set(1, -2, 3);
      this.scene.add(sun);
      const edges = new THREE.EdgesGeometry(new THREE.BoxGeometry(...size.clone().multiplyScalar(this.scale)));
      const box = new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: 0x888888 }));
      box.position.copy(middle);
      this.scene.add(box);
      this.spheres();
      this.look("front");
      this.observer = new ResizeObserver(() => this.fit());
      this.observer.observe(this.$el);
      this.fit();
    },
    spheres() {
      const count = this.diameters.length;
      const fine = count <= 20 ? 32 : count <= 300 ? 20 : 10;
      const body = new THREE.SphereGeometry(0.5, fine, Math.max(6, fine / 2));
      this.mesh = new THREE.InstancedMesh(body, new THREE.MeshLambertMaterial({ map: stripes() }), count);
      this.mesh.frustumCulled = false;
      this.mesh.visible = false;
      for (let n = 0; n < count; n++) this.mesh.setColorAt(n, new THREE.Color(PALETTE[n % PALETTE.length]));
      this.scene.add(this.mesh);
    },
    look(from) {
      if (!this.camera) return;
      this.from = from;
      const size = this.box.map((length) => length * this.scale);
      const way = { front: [0.25, -1, 0.2], corner: [1, -1, 0.7], above: [0.001, -0.05, 1] }[from];
      const turned = this.up === 2 ? way : this.up === 1 ? [way[0], way[2], -way[1]] : [way[2], way[1], way[0]];
      // The box fills the picture: its height upwards, its diagonal across, whichever needs more room.
      const across = Math.hypot(...size.filter((_, n) => n !== this.up));
      const [tall, wide] = from === "above" ? [across, across] : [size[this.up] + 0.25 * across, across];
      const slope = Math.tan((Math.PI * this.camera.fov) / 360);
      const far = Math.max(tall, wide / this.camera.aspect) * 0.53 / slope + 0.5 * (from === "above" ? size[this.up] : across);
      const direction = new THREE.Vector3(...turned).normalize().multiplyScalar(far);
      this.camera.position.set(...size.map((length) => length / 2)).add(direction);
      this.controls.update();
      this.draw();
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
      const p = decode(position), q = decode(rotation);
      const matrix = new THREE.Matrix4(), at = new THREE.Vector3(), turn = new THREE.Quaternion(), size = new THREE.Vector3();
      for (let n = 0; n < Math.min(this.mesh.count, p.length / 3); n++) {
        at.set(p[3 * n], p[3 * n + 1], p[3 * n + 2]).multiplyScalar(this.scale);
        turn.set(q[4 * n], q[4 * n + 1], q[4 * n + 2], q[4 * n + 3]);
        size.setScalar(this.diameters[n] * this.scale);
        this.mesh.setMatrixAt(n, matrix.compose(at, turn, size));
      }
      this.mesh.visible = true;
      this.mesh.instanceMatrix.needsUpdate = true;
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
        this.renderer.render(this.scene, this.camera);
        this.frames += 1;
        this.$el.dataset.frames = this.frames;
      });
    },
  },
};
