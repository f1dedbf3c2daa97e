// Lights that come along with the eye, so that no side is dark.

import { type Camera, DirectionalLight, HemisphereLight, type Scene, Vector3 } from 'three';

const KEY = new Vector3(-0.45, 0.65, 0.7);
const FILL = new Vector3(0.8, 0.1, 0.5);

interface Lights {
  key: DirectionalLight;
  fill: DirectionalLight;
}

export class Rig {
  private readonly lit = new WeakMap<Scene, Lights>();

  /** Lights a scene for a camera. */
  light(scene: Scene, camera: Camera): void {
    // A scene that has lights of its own.
    if (scene.userData['lit']) return;
    const { key, fill } = this.lit.get(scene) ?? this.add(scene);
    camera.updateMatrixWorld();
    for (const [light, from] of [[key, KEY], [fill, FILL]] as const) {
      light.position.copy(from).transformDirection(camera.matrixWorld);
    }
  }

  private add(scene: Scene): Lights {
    const lights = {
      key: new DirectionalLight(0xfff6ea, 2.1),
      fill: new DirectionalLight(0xdfe9ff, 0.6),
    };
    scene.add(new HemisphereLight(0xf2f5ff, 0x4a4640, 1.1), lights.key, lights.fill);
    this.lit.set(scene, lights);
    return lights;
  }
}
