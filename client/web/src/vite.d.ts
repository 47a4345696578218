/** The address of a file that Vite puts beside the page. */
declare module '*?url' {
  const url: string;
  export default url;
}

declare module 'swagger-ui-dist/swagger-ui-es-bundle.js' {
  export default function SwaggerUI(options: Record<string, unknown>): unknown;
}
