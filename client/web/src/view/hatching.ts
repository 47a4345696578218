// Hatching, even on the screen however near a triangle is.
import {Color, DoubleSide, ShaderMaterial} from 'three';

export class Hatching extends ShaderMaterial {
  readonly color = new Color();

  constructor() {
    super({
      side: DoubleSide,
      polygonOffset: true,
      polygonOffsetFactor: -1,
      vertexShader: 'void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }',
      fragmentShader: `uniform vec3 color;
void main() {
  if (mod(gl_FragCoord.x + gl_FragCoord.y, 8.0) > 3.0) discard;
  gl_FragColor = vec4(color, 1.0);
  #include <colorspace_fragment>
}`,
    });
    this.uniforms['color'] = {value: this.color};
  }
}
