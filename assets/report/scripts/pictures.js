// Pictures, loaded when they are looked at. Each is a script that brings a data URL: pages from disk may not read pixels otherwise.
"use strict";

(() => {
  const waiting = new Map();
  const images = new Map();

  function load(id) {
    if (!images.has(id)) {
      images.set(id, new Promise((resolve, reject) => {
        waiting.set(id, { resolve, reject });
        const fail = () => reject(new Error(`pictures/${id}.js is missing`));
        document.head.append(report.make("script", { src: `pictures/${id}.js`, onerror: fail }));
      }));
    }
    return images.get(id);
  }

  async function arrived(id, url) {
    const { resolve, reject } = waiting.get(id);
    const image = new Image();
    image.src = url;
    await image.decode().then(() => resolve(image), reject);
  }

  report.pictures = { load, arrived };
})();
