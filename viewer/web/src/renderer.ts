import {WebGLRenderer} from 'three';

/** Throws Error where the browser gives no WebGL 2: the shaders are written for it, and with WebGL 1 nothing is seen. */
export function rendererOf(canvas: HTMLCanvasElement, antialias: boolean): WebGLRenderer {
  const renderer = new WebGLRenderer({canvas, antialias});
  if (renderer.capabilities.isWebGL2) return renderer;
  renderer.dispose();
  throw new Error('no WebGL 2');
}

/** Does the processor draw, because there is no graphics card (or no driver) for the browser? */
export function isSoftware(renderer: WebGLRenderer): boolean {
  const gl = renderer.getContext();
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  return /swiftshader|llvmpipe|software/i.test(info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : '');
}
