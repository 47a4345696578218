// Elements of the page, by id or made here.

type Child = Node | string | undefined | null | false;
type Properties<T> = Partial<Omit<T, 'style' | 'dataset'>> & {aria?: Record<string, string>};

/** The element of index.html with this id. */
export function $<T extends HTMLElement = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no #${id}`);
  return element as T;
}

export function el<K extends keyof HTMLElementTagNameMap>(
    tag: K, properties: Properties<HTMLElementTagNameMap[K]> = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const {aria = {}, ...rest} = properties;
  const element = Object.assign(document.createElement(tag), rest);
  for (const [name, value] of Object.entries(aria)) element.setAttribute(`aria-${name}`, value);
  element.append(...children.filter((child): child is Node | string => child !== undefined && child !== null && child !== false));
  return element;
}

export function show(element: HTMLElement, visible: boolean): void {
  element.hidden = !visible;
}

/** Shows what is new and moves the keyboard there; its heading or itself takes the focus. */
export function present(element: HTMLElement): void {
  show(element, true);
  const target = element.querySelector<HTMLElement>('h2, h3') ?? element;
  target.tabIndex = -1;
  target.focus({preventScroll: true});
  element.scrollIntoView({block: 'nearest'});
}

/** Says something to those who do not see the page. */
export function announce(text: string): void {
  $('announcement').textContent = text;
}

/** Saves bytes under a name, as a download. */
export function save(blob: Blob, name: string): void {
  const url = URL.createObjectURL(blob);
  el('a', {href: url, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}

/** Computes a value when it is first asked for. */
export function once<T>(compute: () => T): () => T {
  let kept: {value: T} | undefined;
  return () => (kept ??= {value: compute()}).value;
}

/** Calls at most once for each picture; the latest arguments count. */
export function oncePerFrame<A extends unknown[]>(action: (...given: A) => void): (...given: A) => void {
  let latest: A | undefined;
  return (...given) => {
    if (!latest) requestAnimationFrame(() => {
      const now = latest!;
      latest = undefined;
      action(...now);
    });
    latest = given;
  };
}
