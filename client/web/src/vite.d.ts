/** The address of a file that Vite puts beside the page. */
declare module '*?url' {
  const url: string;
  export default url;
}
